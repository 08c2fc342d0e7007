// MIP-map selector (320) of the texel value generator, Figure 3: the level of each pixel from the change of u and v, one pixel per cycle.
//
// Timing twin: the logarithm is in floating point, so the bench passes the levels in (`pass0`).
`default_nettype none
module mip_map_selector #(parameter LATENCY = 2) (
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
    reg [15:0] pixels;
    integer p;
    always @* begin
        pixels = 0;
        for (p = 0; p < 16; p = p + 1) pixels = pixels + in0[`IN0_packet_mask + p];
    end
    assign start = free && in0_valid && out0_room;
    assign in0_pop = start;
    assign out0_reserve = start;
    occupancy busy (.clk, .rst, .start, .cycles(item ? pixels : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 20)) deliver (.clk, .rst, .put(start), .data(item ? pass0 : in0[`OUT0_W-1:0]),
        .latency(item && pixels != 0 ? LATENCY + pixels - 16'd1 : LATENCY), .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(),
        .push(out0_push), .out(out0));
endmodule
`default_nettype wire
