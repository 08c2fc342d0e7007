// Gate (51) of JP H07-72915, Figure 5: passes the specular term of circuit (50) to the adder (52) if register (18) opens it.
`default_nettype none
module gate #(parameter INTERVAL = 1, LATENCY = 1) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    output wire               start
);
    localparam START = 1, DOT = 2;
    wire free;
    wire [1:0] kind = in0[`IN0_kind +: 2];
    reg open;
    assign start = free && in0_valid && out0_room;
    assign in0_pop = start;
    assign out0_reserve = start && kind != START && open;
    always @(posedge clk)
        if (rst) open <= 1'b0;
        else if (start && kind == START) open <= in0[`IN0_open];
    occupancy busy (.clk, .rst, .start, .cycles(kind == DOT ? INTERVAL : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 1)) deliver (.clk, .rst, .put(out0_reserve), .data(in0), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
