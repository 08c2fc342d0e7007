// Divider of the texel value generator (310), Figure 6, steps 610 and 620: u and v at the points between which they are approximated.
//
// COUNT dividers share the divisions of a token, PER_POINT for each point. Timing twin: U, V and W have an exponent and come in floating point,
// so the bench passes the quotients in (`pass0`).
`default_nettype none
module divider #(parameter COUNT = 2, LATENCY = 15, INTERVAL = 15, PER_POINT = 2, PRODUCT = 0, PRODUCTS = 0) (
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
    wire free, item = in0[`IN0_item];
    wire [15:0] points = item ? in0[`IN0_count +: `IN0_count_N] : 16'd0;
    wire [15:0] divisions = points * PER_POINT;
    wire [15:0] shared = (divisions * INTERVAL + COUNT - 1) / COUNT, products = points * PRODUCTS;
    wire [15:0] cycles = shared > products ? shared : products;
    wire [15:0] latency = LATENCY + (divisions - 16'd1) / COUNT * INTERVAL + PRODUCT;
    assign start = free && in0_valid && out0_room;
    assign in0_pop = start;
    assign out0_reserve = start;
    occupancy busy (.clk, .rst, .start, .cycles(points == 0 ? 16'd1 : cycles), .free);
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH + 1)) deliver (.clk, .rst, .put(start), .data(item ? pass0 : in0[`OUT0_W-1:0]),
        .latency(points == 0 ? 16'd0 : latency), .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
