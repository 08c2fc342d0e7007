// Selector (53) of JP H07-72915, Figure 5: passes the output of the adder (52) or of process 24, as the flatness register (16) selects.
//
// Input 0 comes from the adder and carries control, input 1 from process 24. A polygon whose mean brightness goes to this selector is
// drawn from input 1 up to its end.
`default_nettype none
module selector_53 #(parameter INTERVAL = 1, LATENCY = 1) (
    input  wire               clk, rst,
    input  wire               in0_valid, in1_valid,
    input  wire [`IN0_W-1:0]  in0,
    input  wire [`IN1_W-1:0]  in1,
    output wire               in0_pop, in1_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    output wire               start
);
    localparam FIGURE = 1, DOT = 2, END = 3, NORMAL = 0;
    wire free;
    reg flat;
    wire [`IN0_W-1:0] token = flat ? in1 : in0;
    wire [1:0] kind = token[`IN0_kind +: 2];
    assign start = free && (flat ? in1_valid : in0_valid) && out0_room;
    assign in0_pop = start && !flat;
    assign in1_pop = start && flat;
    assign out0_reserve = start;
    always @(posedge clk)
        if (rst) flat <= 1'b0;
        else if (start && kind == FIGURE) flat <= token[`IN0_mode +: 2] == NORMAL && token[`IN0_flat];
        else if (start && kind == END && !token[`IN0_frame_end]) flat <= 1'b0;
    occupancy busy (.clk, .rst, .start, .cycles(kind == DOT ? INTERVAL : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 1)) deliver (.clk, .rst, .put(start), .data(token), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
