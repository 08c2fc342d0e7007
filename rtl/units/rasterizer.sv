// Rasterizer of the bump-mapping processor, Figure 1: passes control, then emits the stamps of a polygon, one fragment per PACE cycles.
//
// Timing twin: coverage and attributes are in floating point, so the bench passes the stamps in (`pass0`). A polygon without stamps
// shows by the control token that follows it.
`default_nettype none
module rasterizer #(parameter LATENCY = 1, PACE = 1, parameter [16*16-1:0] SET_UP = 0) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire [`OUT0_W-1:0] pass0,
    output wire               start
);
    localparam POLYGON = 2;
    wire free;
    // The next token is a stamp while a polygon has pixels left.
    wire draws = pass0[`OUT0_item];
    wire [15:0] pixels = {{(16-`OUT0_count_N){1'b0}}, pass0[`OUT0_count +: `OUT0_count_N]};
    assign start = free && (draws || in0_valid) && out0_room;
    assign in0_pop = start && !draws;
    assign out0_reserve = start;
    wire is_polygon = in0[`IN0_kind +: 3] == POLYGON;
    wire [15:0] set_up = is_polygon ? SET_UP[in0[`IN0_triangles +: 4]*16 +: 16] : 16'd1;
    reg [`OUT0_W-1:0] control;
    always @* begin
        control = 0;
        control[`OUT0_kind +: 3] = in0[`IN0_kind +: 3];
        control[`OUT0_number +: `IN0_W - 3] = in0[`IN0_number +: `IN0_W - 3];
    end
    occupancy busy (.clk, .rst, .start, .cycles(draws ? pixels * PACE : set_up), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 4)) deliver (.clk, .rst, .put(start), .data(draws ? pass0 : control),
        .latency(draws ? LATENCY + (pixels - 1) * PACE : LATENCY), .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(),
        .push(out0_push), .out(out0));
endmodule
`default_nettype wire
