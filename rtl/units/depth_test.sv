// Depth test with clear flags: of the bump-mapping processor, Figure 1 (in the graphics processor (104)), and as addition to the figure shading
// device and the texel value generator. Passes fragments in front of all earlier ones, and owns the z-buffer.
//
// Client 0 looks up z values in the z-cache, client 1 writes whole lines. Values are tested in the first cycle of a token: the memory holds
// back the token, not the values (law 6), so here they lie in an array beside the unit. PIXELS bounds the picture.
`default_nettype none
module depth_test #(parameter PACKETS = 0, Z = 24, LATENCY = 1, LINES = 8, FLAGS = 512, LIMIT = 131072, PER_CYCLE = 64, LINE_BYTES = 64,
        PIXELS = 4096, parameter [63:0] BASE = 0) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire               mem0_ready, mem1_ready,
    input  wire [31:0]        answered,
    output wire               mem1_request,
    output wire [47:0]        mem1_address,
    output wire               start
);
    localparam FRAME = 0, FRAME_END = 4, A = $clog2(PIXELS);
    wire free, item = in0[`IN0_item];
    wire [2:0] kind = in0[`IN0_kind +: 3];
    reg [15:0] width, height;
    reg ending;
    wire has_unflagged;
    wire holds = ending || has_unflagged;
    assign start = free && (holds || in0_valid) && out0_room && mem0_ready && mem1_ready;
    assign in0_pop = start && !holds;
    wire takes_item = in0_pop && item, takes_frame = in0_pop && !item && kind == FRAME;
    wire ends = start && (ending || (!holds && !item && kind == FRAME_END));
    reg [15:0] frame;
    reg [Z+15:0] values [0:PIXELS-1];
    wire any_pixel, any_passed;
    wire [15:0] x, y, pixels;
    token_line #(.PACKETS(PACKETS)) of_token (.token(in0), .width, .height, .any(any_pixel), .x, .y, .pixels);
    reg [15:0] passed;
    reg [`OUT0_W-1:0] result;
    reg [31:0] at [0:15];
    reg [Z-1:0] depth [0:15];
    reg [15:0] covered;
    reg [16*Z-1:0] fragments, stored;
    integer p, kept;
    always @* begin
        covered = 0;
        fragments = 0;
        stored = 0;
        for (p = 0; p < 16; p = p + 1) begin
            at[p] = 0;
            depth[p] = 0;
        end
`ifdef IN0_STAMP
        for (p = 0; p < `IN0_STAMP; p = p + 1) begin
            at[p] = in0[`IN0_0_y + p * `IN0_STRIDE +: 16] * width + in0[`IN0_0_x + p * `IN0_STRIDE +: 16];
            depth[p] = in0[`IN0_0_z + p * `IN0_STRIDE +: Z];
            covered[p] = p < pixels && in0[`IN0_0_x + p * `IN0_STRIDE +: 16] < width && in0[`IN0_0_y + p * `IN0_STRIDE +: 16] < height;
        end
`endif
`ifdef IN0_packet_mask
        for (p = 0; p < 16; p = p + 1) begin
            at[p] = in0[`IN0_packet_y +: 16] * width + in0[`IN0_packet_x +: 16] + p;
            depth[p] = in0[`IN0_0_z + p * (`IN0_1_z - `IN0_0_z) +: Z];
            covered[p] = in0[`IN0_packet_mask + p] && in0[`IN0_packet_x +: 16] + p < width && in0[`IN0_packet_y +: 16] < height;
        end
`endif
        // A value counts if it was written in this frame.
        for (p = 0; p < 16; p = p + 1) begin
            fragments[p*Z +: Z] = depth[p];
            stored[p*Z +: Z] = values[at[p][A-1:0]][Z +: 16] == frame ? values[at[p][A-1:0]][0 +: Z] : {Z{1'b1}};
        end
    end
    wire [15:0] is_nearer;
    genvar g;
    generate
        for (g = 0; g < 16; g = g + 1) begin : comparison
            nearer #(.Z(Z)) compare (.fragment(fragments[g*Z +: Z]), .stored(stored[g*Z +: Z]), .passes(is_nearer[g]));
        end
    endgenerate
    always @* begin
        passed = covered & is_nearer;
        result = in0;
        kept = 0;
`ifdef IN0_STAMP
        // The fragments that pass move together.
        if (item) begin
            for (p = 0; p < `IN0_STAMP; p = p + 1) result[`OUT0_0_x + p * `IN0_STRIDE +: `IN0_LANE] = 0;
            for (p = 0; p < `IN0_STAMP; p = p + 1)
                if (passed[p]) begin
                    result[`OUT0_0_x + kept * `IN0_STRIDE +: `IN0_LANE] = in0[`IN0_0_x + p * `IN0_STRIDE +: `IN0_LANE];
                    kept = kept + 1;
                end
            result[`OUT0_count +: `OUT0_count_N] = kept;
        end
`endif
`ifdef IN0_packet_mask
        if (item) result[`OUT0_packet_mask +: 16] = passed;
`endif
    end
    assign any_passed = passed != 0;
    wire [31:0] columns = PACKETS ? (width + 15) >> 4 : (width + 3) >> 2;
    wire [31:0] line = PACKETS ? y * columns + (x >> 4) : (y >> 2) * columns + (x >> 2);
    wire [31:0] new_width = in0[`IN0_width +: 16], new_height = in0[`IN0_height +: 16];
    wire [31:0] all = PACKETS ? new_height * ((new_width + 15) >> 4) : ((new_height + 3) >> 2) * ((new_width + 3) >> 2);
    wire is_newest, contains, evicts, is_clear;
    wire [31:0] oldest, unflagged, set_cycles;
    wire [7:0] gathered;
    wire gathers = takes_item && any_passed && !is_newest;
    wire writes_gathered = ends && gathered != 0, writes_unflagged = start && holds && !ending;
    gathered_lines #(.LINES(LINES)) gather (.clk, .clear(rst || takes_frame), .line, .touch(gathers), .take(writes_gathered),
        .is_newest, .contains, .evicts, .oldest, .count(gathered));
    line_flags #(.FLAGS(FLAGS), .LIMIT(LIMIT), .PER_CYCLE(PER_CYCLE)) flags (.clk, .rst, .set(takes_frame), .lines(all), .line,
        .draw(gathers), .examine(1'b0), .write_unflagged(writes_unflagged), .is_clear, .has_unflagged, .is_found(), .unflagged, .found(),
        .set_cycles, .examine_cycles());
    // The frame end travels on with the last gathered line.
    wire is_last = gathered <= 1;
    assign out0_reserve = takes_item ? any_passed || PACKETS : ends ? is_last : in0_pop;
    wire looks_up = takes_item && (covered != 0) && !contains && !is_clear;
    assign mem1_request = evicts || writes_gathered || writes_unflagged;
    assign mem1_address = BASE + (writes_unflagged ? unflagged : oldest) * LINE_BYTES;
    wire [15:0] last = pixels == 0 ? 16'd0 : pixels - 16'd1;
    reg [`OUT0_W-1:0] frame_end;
    occupancy #(.W(32)) busy (.clk, .rst, .start, .free, .cycles(takes_item ? {16'd0, pixels} : takes_frame ? set_cycles : 32'd1));
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(out0_reserve), .data(ending ? frame_end : result),
        .latency(takes_item ? LATENCY + last : LATENCY), .counts(looks_up && out0_reserve), .after(LATENCY), .answered, .asked(),
        .push(out0_push), .out(out0));
    always @(posedge clk)
        if (rst) begin
            ending <= 1'b0;
            frame <= 0;
            width <= 0;
            height <= 0;
        end else begin
            if (takes_frame) begin
                width <= in0[`IN0_width +: 16];
                height <= in0[`IN0_height +: 16];
                frame <= frame + 16'd1;
            end
            if (takes_item)
                for (p = 0; p < 16; p = p + 1)
                    if (passed[p]) values[at[p][A-1:0]] <= {frame, depth[p]};
            if (ends) begin
                ending <= !is_last;
                if (!ending) frame_end <= in0;
            end
        end
endmodule
`default_nettype wire
