// Brightness fetch unit (112), Figure 1: reads the brightness of each index in the CLUT (122) of its level, and interpolates between levels.
//
// The first fragment that needs a level of a set of CLUTs has it calculated: reference normals are read on client 1, lit in
// ENTRY_CYCLES each, and written back. The fragment waits. Client 0 looks entries up in a cache. A set belongs to a material and lights; set-up
// registers give its number (`set`). Entries lie in an array beside the unit, because the memory holds back the token, not the values (law 6).
// A brightness leaves as a whole number of steps of 1 / (255 * 128) of full scale.
`default_nettype none
module brightness #(parameter LATENCY = 2, ENTRIES = 256, SETS = 16, STRIDE = 256, ENTRY_CYCLES = 43, NORMAL_BYTES = 6, BATCH = 32,
        CLUTS = 1 << 22, VQ_STRIDE = 1 << 19) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire               mem0_ready, mem1_ready,
    input  wire [31:0]        answered,
    output wire               mem1_request, mem2_request,
    output wire [47:0]        mem1_address, mem2_address,
    output wire               start
);
    localparam SAMPLE = `IN0_sample_1_level - `IN0_sample_0_level, LANE = `IN0_sample_0_1_share - `IN0_sample_0_0_share;
    localparam IN_LANE = `IN0_stamp_1_x - `IN0_stamp_0_x, OUT_LANE = `OUT0_1_x - `OUT0_0_x, FRAGMENT = `OUT0_0_brightness - `OUT0_0_x;
    localparam CODE_BOOK = 3, S = SETS > 1 ? $clog2(SETS) : 1, E = $clog2(ENTRIES);
    reg [7:0] entries [0:SETS*8*ENTRIES-1];
    initial $readmemh("clut.hex", entries);
    reg [SETS*8-1:0] calculated;
    reg holds, building, blocking;
    reg [`IN0_W-1:0] token;
    reg [2:0] level;
    reg [15:0] read, lit, written;
    wire free;
    wire [31:0] asked;
    reg [31:0] blocks;
    // The unit waits for the reads of its last step.
    wire is_blocked = blocking && answered < blocks;
    assign start = free && !is_blocked && (holds || in0_valid) && out0_room && mem0_ready && mem1_ready;
    assign in0_pop = start && !holds;
    wire [`IN0_W-1:0] current = holds ? token : in0;
    wire item = current[`IN0_item];
    wire [S-1:0] set = current[`IN0_set +: S];
    wire [2:0] samples = current[`IN0_samples +: `IN0_samples_N];
    reg lacks;
    reg [2:0] lacking;
    integer j, l;
    always @* begin
        lacks = 1'b0;
        lacking = 0;
        for (j = 1; j >= 0; j = j - 1)
            if (j < samples && !calculated[{set, current[`IN0_sample_0_level + j * SAMPLE +: 3]}]) begin
                lacks = 1'b1;
                lacking = current[`IN0_sample_0_level + j * SAMPLE +: 3];
            end
    end
    wire begins = start && item && !building && lacks, builds = begins || (start && building);
    wire fetches = start && item && !building && !lacks;
    // Calculation: read, light and write overlap by a batch.
    wire [2:0] of = begins ? lacking : level;
    wire [15:0] r = begins ? 16'd0 : read, c = begins ? 16'd0 : lit, w = begins ? 16'd0 : written;
    wire [15:0] count = ENTRIES - r < BATCH ? ENTRIES - r : BATCH;
    assign mem1_request = builds && count != 0;
    assign mem1_address = of * VQ_STRIDE + r * NORMAL_BYTES;
    assign mem2_request = builds && c > w;
    assign mem2_address = CLUTS + {set, of} * STRIDE + w;
    wire [31:0] lighting = (r - c) * ENTRY_CYCLES;
    // Interpolation.
    wire [15:0] pixels = current[`IN0_stamp_count +: `IN0_stamp_count_N];
    wire [4*17-1:0] sums;
    reg [4*16-1:0] shares, values;
    always @* begin
        shares = 0;
        values = 0;
        for (l = 0; l < 4; l = l + 1)
            for (j = 0; j < 2; j = j + 1)
                if (j < samples) begin
                    shares[16*l + 8*j +: 8] = current[`IN0_sample_0_0_share + j * SAMPLE + l * LANE +: 8];
                    values[16*l + 8*j +: 8] = entries[{set, current[`IN0_sample_0_level + j * SAMPLE +: 3],
                        current[`IN0_sample_0_0_index + j * SAMPLE + l * LANE +: E]}];
                end
    end
    genvar g;
    generate
        for (g = 0; g < 4; g = g + 1) begin : fragment
            blend interpolate (.shares(shares[16*g +: 16]), .entries(values[16*g +: 16]), .sum(sums[17*g +: 17]));
        end
    endgenerate
    reg [`OUT0_W-1:0] result;
    always @* begin
        result = 0;
        if (item) begin
            result[`OUT0_item] = 1'b1;
            result[`OUT0_count +: `OUT0_count_N] = pixels;
            for (l = 0; l < 4; l = l + 1) begin
                result[`OUT0_0_x + l * OUT_LANE +: FRAGMENT] = current[`IN0_stamp_0_x + l * IN_LANE +: FRAGMENT];
                if (l < pixels) result[`OUT0_0_brightness + l * OUT_LANE +: 17] = sums[17*l +: 17];
            end
        end else result[`OUT0_triangles + `OUT0_triangles_N - 1:0] = current[`OUT0_triangles + `OUT0_triangles_N - 1:0];
    end
    assign out0_reserve = fetches || (in0_pop && !item && current[`IN0_kind +: 3] != CODE_BOOK);
    occupancy #(.W(32)) busy (.clk, .rst, .start, .free, .cycles(fetches ? {16'd0, pixels} : builds && lighting != 0 ? lighting : 32'd1));
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(out0_reserve), .data(result),
        .latency(fetches ? LATENCY + pixels - 16'd1 : LATENCY), .counts(fetches || mem1_request), .after(LATENCY), .answered, .asked,
        .push(out0_push), .out(out0));
    always @(posedge clk)
        if (rst) begin
            calculated <= 0;
            holds <= 1'b0;
            building <= 1'b0;
            blocking <= 1'b0;
        end else begin
            if (in0_pop) token <= in0;
            if (start) begin
                holds <= builds;
                blocking <= mem1_request;
                blocks <= asked + 32'd1;
            end
            if (builds) begin
                level <= of;
                read <= r + count;
                lit <= r;
                written <= c;
                building <= c < ENTRIES;
                calculated[{set, of}] <= 1'b1;
            end
        end
endmodule
`default_nettype wire
