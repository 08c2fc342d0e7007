// Normal-vector replacement unit (110), Figure 1: replaces each pseudo-normal N' by the index of the nearest reference normal in the VQ
// table (121) of its level. LANES inner products side by side search a table row by row. The two tables used last are resident.
//
// A stamp whose tables are not resident loads them, LOAD_BYTES per read on client 0. The unit waits for the last read, then searches: all samples of the
// first fragment, then those of the second. Tables have the same size at all levels and need no code book.
`default_nettype none
module replacement #(parameter LANES = 64, ENTRIES = 256, LATENCY = 11, LOAD_BYTES = 64, LOADS = 24, STRIDE = 65536, BASE = 0) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire               mem0_ready,
    input  wire [31:0]        answered,
    output wire               mem0_request,
    output wire [47:0]        mem0_address,
    output wire               start
);
    localparam ROWS = ENTRIES / LANES, R = ROWS > 1 ? $clog2(ROWS) : 1, I = $clog2(LANES);
    localparam IN_SAMPLE = `IN0_sample_1_level - `IN0_sample_0_level, IN_LANE = `IN0_sample_0_1_share - `IN0_sample_0_0_share;
    localparam OUT_SAMPLE = `OUT0_sample_1_level - `OUT0_sample_0_level, OUT_LANE = `OUT0_sample_0_1_share - `OUT0_sample_0_0_share;
    localparam IDLE = 0, LOADING = 1, PENDING = 2, SEARCHING = 3;
    reg [LANES*48-1:0] tables [0:8*ROWS-1];
    initial $readmemh("tables.hex", tables);
    reg [1:0] state;
    reg [`IN0_W-1:0] token;
    // Resident tables, the one used last first; then the tables that a stamp misses, in order of its samples.
    reg [2:0] resident [0:1];
    reg [1:0] is_resident;
    reg [2:0] new_resident [0:1], missing [0:1];
    reg [1:0] new_is_resident, misses;
    reg [2:0] level;
    integer j;
    always @* begin
        new_resident[0] = resident[0];
        new_resident[1] = resident[1];
        new_is_resident = is_resident;
        missing[0] = 0;
        missing[1] = 0;
        misses = 0;
        level = 0;
        for (j = 0; j < 2; j = j + 1)
            if (j < in0[`IN0_samples +: `IN0_samples_N]) begin
                level = in0[`IN0_sample_0_level + j * IN_SAMPLE +: 3];
                if (!(new_is_resident[0] && new_resident[0] == level)) begin
                    if (!(new_is_resident[1] && new_resident[1] == level)) begin
                        missing[misses[0]] = level;
                        misses = misses + 2'd1;
                        new_is_resident = {new_is_resident[0], 1'b1};
                    end
                    new_resident[1] = new_resident[0];
                    new_resident[0] = level;
                end
            end
    end
    // Loads.
    reg [2:0] loads [0:1];
    reg [1:0] tables_left;
    reg [15:0] read;
    reg [31:0] blocks;
    reg waits;
    wire is_blocked = waits && answered < blocks;
    wire takes = state == IDLE && in0_valid && out0_room && mem0_ready;
    wire loads_now = state == LOADING && out0_room && mem0_ready;
    wire searches_now = state == PENDING && !is_blocked && out0_room && mem0_ready;
    assign start = takes || loads_now || searches_now;
    assign in0_pop = takes;
    wire item = in0[`IN0_item];
    wire begins_load = takes && item && misses != 0, begins = searches_now || (takes && item && misses == 0);
    wire control = takes && !item;
    wire [2:0] load_level = takes ? missing[0] : loads[0];
    wire [15:0] load_number = takes ? 16'd0 : read;
    wire [1:0] left = takes ? misses : tables_left;
    wire ends_table = load_number == LOADS - 1, ends_loads = ends_table && left == 1;
    assign mem0_request = begins_load || loads_now;
    assign mem0_address = BASE + load_level * STRIDE + load_number * LOAD_BYTES;
    // Search: fragment, sample, row.
    reg [1:0] fragment;
    reg sample;
    reg [R-1:0] row;
    wire searching = begins || state == SEARCHING;
    wire [`IN0_W-1:0] current = takes ? in0 : token;
    wire [1:0] f = begins ? 2'd0 : fragment;
    wire s = begins ? 1'b0 : sample;
    wire [R-1:0] r = begins ? {R{1'b0}} : row;
    wire signed [33:0] row_best;
    wire [I-1:0] row_lane;
    wire [2:0] of_level = current[`IN0_sample_0_level + s * IN_SAMPLE +: 3];
    lanes #(.LANES(LANES)) search (.enable(searching), .normal(current[`IN0_sample_0_0_nx + s * IN_SAMPLE + f * IN_LANE +: 48]),
        .row(tables[of_level * ROWS + r]), .best(row_best), .lane(row_lane));
    reg signed [33:0] best;
    reg [`OUT0_sample_0_0_index_N-1:0] best_index;
    wire better = r == 0 || row_best > best;
    wire [`OUT0_sample_0_0_index_N-1:0] index = better ? r * LANES + row_lane : best_index;
    wire row_end = r == ROWS - 1, sample_end = row_end && s + 2'd1 == current[`IN0_samples +: `IN0_samples_N];
    wire done = searching && sample_end && f + 3'd1 == current[`IN0_stamp_count +: `IN0_stamp_count_N];
    reg [`OUT0_W-1:0] result, gathered;
    integer l;
    always @* begin
        result = searching && !begins ? gathered : {`OUT0_W{1'b0}};
        if (!searching) result[`OUT0_W-1:0] = current;
        else if (begins) begin
            result[0 +: `OUT0_sample_0_level] = current[0 +: `OUT0_sample_0_level];
            for (j = 0; j < 2; j = j + 1) begin
                result[`OUT0_sample_0_level + j * OUT_SAMPLE +: 3] = current[`IN0_sample_0_level + j * IN_SAMPLE +: 3];
                for (l = 0; l < 4; l = l + 1)
                    result[`OUT0_sample_0_0_share + j * OUT_SAMPLE + l * OUT_LANE +: 8] =
                        current[`IN0_sample_0_0_share + j * IN_SAMPLE + l * IN_LANE +: 8];
            end
        end
        if (searching && row_end) result[`OUT0_sample_0_0_index + s * OUT_SAMPLE + f * OUT_LANE +: `OUT0_sample_0_0_index_N] = index;
    end
    assign out0_reserve = control || begins;
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 2)) deliver (.clk, .rst, .put(control || done), .data(result), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
    always @(posedge clk)
        if (rst) begin
            state <= IDLE;
            is_resident <= 0;
            waits <= 1'b0;
            blocks <= 0;
        end else begin
            if (takes) token <= in0;
            if (takes && item) begin
                resident[0] <= new_resident[0];
                resident[1] <= new_resident[1];
                is_resident <= new_is_resident;
                loads[0] <= missing[0];
                loads[1] <= missing[1];
            end
            if (mem0_request) begin
                read <= ends_table ? 16'd0 : load_number + 16'd1;
                tables_left <= ends_table ? left - 2'd1 : left;
                if (ends_table) loads[0] <= takes ? missing[1] : loads[1];
                if (ends_loads) blocks <= blocks + 1;
                waits <= ends_loads;
                state <= ends_loads ? PENDING : LOADING;
            end
            if (begins) waits <= 1'b0;
            if (searching) begin
                if (better) best <= row_best;
                best_index <= index;
                gathered <= result;
                row <= row_end ? {R{1'b0}} : r + 1'b1;
                sample <= row_end ? !sample_end : s;
                fragment <= sample_end ? f + 2'd1 : f;
                state <= done ? IDLE : SEARCHING;
            end
        end
endmodule
`default_nettype wire
