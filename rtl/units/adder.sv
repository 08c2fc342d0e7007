// Adder (52) of JP H07-72915, Figure 5: adds the output of circuit (21) and the output of circuit (50) that passes gate (51), and saturates nothing.
//
// Input 0 comes from circuit (21) and carries control, input 1 comes from the gate. A polygon joins both if register (18) is set, in
// normal-interpolation mode, and the polygon is not flat.
`default_nettype none
module adder #(parameter INTERVAL = 1, LATENCY = 3) (
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
    localparam FIGURE = 1, DOT = 2, NORMAL = 0;
    wire free;
    reg joins;
    wire [1:0] kind = in0[`IN0_kind +: 2];
    assign start = free && in0_valid && (in1_valid || !joins) && out0_room;
    assign in0_pop = start;
    assign in1_pop = start && joins;
    assign out0_reserve = start;
    wire selects = in0[`IN0_mode +: 2] == NORMAL && !in0[`IN0_flat] && in0[`IN0_specular];
    always @(posedge clk)
        if (rst) joins <= 1'b0;
        else if (start && kind != DOT) joins <= kind == FIGURE && selects;
    wire [31:0] red, green, blue;
    wire [31:0] highlight = in1[`IN1_brightness +: 32];
    float_add add_red (.a(in0[`IN0_red +: 32]), .b(highlight), .sum(red));
    float_add add_green (.a(in0[`IN0_green +: 32]), .b(highlight), .sum(green));
    float_add add_blue (.a(in0[`IN0_blue +: 32]), .b(highlight), .sum(blue));
    reg [`OUT0_W-1:0] result;
    always @* begin
        result = in0;
        if (kind == DOT && joins) begin
            result[`OUT0_red +: 32] = red;
            result[`OUT0_green +: 32] = green;
            result[`OUT0_blue +: 32] = blue;
        end
    end
    occupancy busy (.clk, .rst, .start, .cycles(kind == DOT ? INTERVAL : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 1)) deliver (.clk, .rst, .put(start), .data(result), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
