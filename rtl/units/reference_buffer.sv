// Reference buffer (126) of the rate-limited renderer, Figures 3A, 3B and 4B: one cell per pixel. The initial rasterization (454) fills it,
// then passes read it: one for the identification of tiles (461) if BEST, and one per picture (463, 472).
//
// Client 0 reads blocks of 4 x 4 cells, client 1 writes gathered blocks. Cells lie in an array beside the unit, because the memory holds back
// the token, not the values (law 6). PIXELS bounds the picture. A block with a flag is empty and not read. Blocks beyond LIMIT flags are cleared
// at the beginning of the frame.
`default_nettype none
module reference_buffer #(parameter LATENCY = 8, LINES = 8, SCAN = 1, CELL_BYTES = 16, BEST = 1, LIMIT = 131072, PER_CYCLE = 64,
                          PIXELS = 4096) (
    input  wire               clk, rst,
    input  wire               in0_valid, in1_valid,
    input  wire [`IN0_W-1:0]  in0,
    input  wire [`IN1_W-1:0]  in1,
    output wire               in0_pop, in1_pop,
    input  wire               out0_room, out1_room,
    output wire               out0_reserve, out0_push, out1_reserve, out1_push,
    output wire [`OUT0_W-1:0] out0,
    output wire [`OUT1_W-1:0] out1,
    input  wire               mem0_ready, mem1_ready,
    input  wire [31:0]        answered,
    output wire               mem0_request, mem1_request,
    output wire [47:0]        mem0_address, mem1_address,
    output wire               start
);
    localparam FILL = 0, FLUSH = 1, IDENTIFY = 2, BEGIN = 3, COLOUR = 4, WAIT = 5;
    localparam FRAME = 0, PAGE = 1, CELLS = 2, FRAME_END = 3, PASS_BEGIN = 3, PASS_END = 4;
    localparam CELL = `OUT0_1_page - `OUT0_0_page, A = $clog2(PIXELS), BYTES = 16 * CELL_BYTES;
    localparam [15:0] NO_PAGE = 16'hffff;
    localparam [CELL-1:0] EMPTY = {{(CELL-16){1'b0}}, NO_PAGE};
    wire free;
    reg [2:0] phase;
    reg [15:0] width, height;
    reg [31:0] block;
    reg [CELL-1:0] cells [0:PIXELS-1];
    wire [1:0] kind = in0[`IN0_kind +: 2];
    wire has_unflagged, is_clear;
    wire [31:0] unflagged, set_cycles;
    wire fills = phase == FILL && !has_unflagged, passes = phase == IDENTIFY || phase == COLOUR;
    assign start = free && (fills ? in0_valid : phase == WAIT ? in1_valid : 1'b1) && out0_room && out1_room && mem0_ready && mem1_ready;
    assign in0_pop = start && fills;
    assign in1_pop = start && phase == WAIT;
    wire takes_cells = in0_pop && kind == CELLS, takes_frame = in0_pop && kind == FRAME;
    wire passes_on = takes_frame || (in0_pop && kind == PAGE);
    wire flushes = start && (phase == FLUSH || (fills && kind == FRAME_END)), clears = start && phase == FILL && has_unflagged;
    wire [31:0] columns = (width + 3) >> 2, rows = (height + 3) >> 2;
    // The cells of a token lie in one block.
    wire [15:0] x = in0[`IN0_0_x +: 16], y = in0[`IN0_0_y +: 16], count = in0[`IN0_count +: `IN0_count_N];
    wire [31:0] written = (y >> 2) * columns + (x >> 2), oldest;
    wire is_newest, evicts;
    wire [7:0] gathered;
    gathered_lines #(.LINES(LINES)) gather (.clk, .clear(rst || takes_frame), .line(written), .touch(takes_cells && !is_newest), .take(flushes),
        .is_newest, .contains(), .evicts, .oldest, .count(gathered));
    wire [31:0] new_columns = (in0[`IN0_width +: 16] + 32'd3) >> 2, new_rows = (in0[`IN0_height +: 16] + 32'd3) >> 2;
    line_flags #(.FLAGS(PIXELS / 16), .LIMIT(LIMIT), .PER_CYCLE(PER_CYCLE)) flags (.clk, .rst, .set(takes_frame), .lines(new_columns * new_rows),
        .line(passes ? block : written), .draw(takes_cells), .examine(1'b0), .write_unflagged(clears), .is_clear, .has_unflagged, .is_found(),
        .unflagged, .found(), .set_cycles, .examine_cycles());
    wire is_filled = flushes && gathered <= 1, at_end = block == columns * rows, reads = start && passes && !at_end;
    assign mem0_request = reads && !is_clear;
    assign mem0_address = block * BYTES;
    assign mem1_request = evicts || (flushes && gathered != 0) || clears;
    assign mem1_address = (clears ? unflagged : oldest) * BYTES;
    reg [`OUT0_W-1:0] pass;
    reg [15:0] mask;
    reg [CELL-1:0] stored;
    integer p;
    always @* begin
        pass = 0;
        mask = 0;
        stored = 0;
        if (passes_on) begin
            pass[`OUT0_kind +: 3] = kind;
            pass[`OUT0_number +: 64] = in0[`IN0_number +: 64];
        end else if (reads) begin
            pass[`OUT0_kind +: 3] = CELLS;
            pass[`OUT0_x +: 16] = block % columns;
            pass[`OUT0_y +: 16] = block / columns;
            for (p = 0; p < 16; p = p + 1) begin
                stored = is_clear ? EMPTY : cells[block * 16 + p];
                pass[`OUT0_0_page + p * CELL +: CELL] = stored;
                mask[p] = stored[15:0] != NO_PAGE;
            end
            pass[`OUT0_mask +: 16] = mask;
        end else pass[`OUT0_kind +: 3] = phase == BEGIN ? PASS_BEGIN : PASS_END;
    end
    assign out0_reserve = passes_on || (start && phase == IDENTIFY && (at_end || mask != 0)) || (is_filled && !BEST);
    assign out1_reserve = passes_on || (start && (phase == COLOUR || phase == BEGIN));
    wire counts = mem0_request && (out0_reserve || out1_reserve);
    occupancy #(.W(32)) busy (.clk, .rst, .start, .free,
        .cycles(takes_cells ? {16'd0, count} : takes_frame ? set_cycles : reads ? (16 + SCAN - 1) / SCAN : 32'd1));
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) identify (.clk, .rst, .put(out0_reserve), .data(pass), .latency(LATENCY), .counts, .after(16'd0),
        .answered, .asked(), .push(out0_push), .out(out0));
    delivery #(.W(`OUT1_W), .DEPTH(`OUT1_DEPTH)) colour (.clk, .rst, .put(out1_reserve), .data(pass), .latency(LATENCY), .counts, .after(16'd0),
        .answered, .asked(), .push(out1_push), .out(out1));
    reg [15:0] px, py;
    always @(posedge clk)
        if (rst) begin
            phase <= FILL;
            width <= 0;
            height <= 0;
        end else begin
            if (takes_frame) begin
                width <= in0[`IN0_width +: 16];
                height <= in0[`IN0_height +: 16];
            end
            if (clears || (takes_cells && is_clear))
                for (p = 0; p < 16; p = p + 1) cells[(clears ? unflagged[A-1:0] : written[A-1:0]) * 16 + p] <= EMPTY;
            if (takes_cells)
                for (p = 0; p < `IN0_STAMP; p = p + 1) begin
                    px = in0[`IN0_0_x + p * `IN0_STRIDE +: 16];
                    py = in0[`IN0_0_y + p * `IN0_STRIDE +: 16];
                    if (p < count) cells[written[A-1:0] * 16 + py[1:0] * 4 + px[1:0]] <= in0[`IN0_0_page + p * `IN0_STRIDE +: CELL];
                end
            if (flushes) phase <= !is_filled ? FLUSH : BEST ? IDENTIFY : BEGIN;
            if (start && passes) begin
                block <= block + 32'd1;
                if (at_end) phase <= phase == IDENTIFY ? BEGIN : WAIT;
            end else if (start) block <= 0;
            if (start && phase == BEGIN) phase <= COLOUR;
            if (in1_pop) phase <= in1[`IN1_again] ? BEGIN : FILL;
        end
endmodule
`default_nettype wire
