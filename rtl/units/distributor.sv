// Distributor of the bump-mapping processor, Figure 1: sends stamps of bump targets to output 0, to the bump-mapping processor (106), and
// others to output 1, to the graphics processor (104).
//
// All control goes to output 0. Output 1 gets duplicates of the token that begins a plain polygon and of the token that ends it.
`default_nettype none
module distributor (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room, out1_room,
    output wire               out0_reserve, out0_push, out1_reserve, out1_push,
    output wire [`OUT0_W-1:0] out0, out1,
    output wire               start
);
    localparam POLYGON = 2;
    reg plain;
    wire item = in0[`IN0_item];
    wire begins_plain = !item && in0[`IN0_kind +: 3] == POLYGON && !in0[`IN0_bump];
    assign start = in0_valid && out0_room && out1_room;
    assign in0_pop = start;
    assign out0_reserve = start && !(item && plain);
    assign out1_reserve = start && (plain || begins_plain);
    // A token is delivered in the cycle of its start.
    assign out0_push = out0_reserve;
    assign out1_push = out1_reserve;
    assign out0 = in0;
    assign out1 = in0;
    always @(posedge clk)
        if (rst) plain <= 1'b0;
        else if (start && !item) plain <= begins_plain;
endmodule
`default_nettype wire
