// Brightness interpolation circuit (21) of JP H07-72915, Figure 1: brightness and screen address of every dot of a polygon, equation (6).
//
// Output 0 goes to the adder (52): all control, and the dots in normal-interpolation mode. Output 1 goes to selector (28): dots in
// brightness-interpolation mode. Timing twin: dots are in floating point, so the bench passes them in (`pass0`, `pass1`).
`default_nettype none
module brightness_interpolation #(parameter INTERVAL = 1, LATENCY = 1, SET_UP = 1) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room, out1_room,
    output wire               out0_reserve, out0_push, out1_reserve, out1_push,
    output wire [`OUT0_W-1:0] out0, out1,
    input  wire [`OUT0_W-1:0] pass0, pass1,
    output wire               start
);
    localparam FIGURE = 1, DOT = 2, NORMAL = 0, POLYHEDRON = 2;
    wire free;
    reg draws, to_adder;
    wire [1:0] mode = in0[`IN0_mode +: 2];
    wire is_figure = in0[`IN0_kind +: 2] == FIGURE;
    // Process 24 draws the mean of the sample points.
    wire is_mean = mode == POLYHEDRON || in0[`IN0_flat];
    assign start = free && (draws || in0_valid) && out0_room && out1_room;
    assign in0_pop = start && !draws;
    assign out0_reserve = start && (!draws || to_adder);
    assign out1_reserve = start && draws && !to_adder;
    wire [`OUT0_W-1:0] drawn = to_adder ? pass0 : pass1;
    wire is_dot = drawn[`OUT0_kind +: 2] == DOT;
    always @(posedge clk)
        if (rst) draws <= 1'b0;
        else if (start && draws) draws <= is_dot;
        else if (start && is_figure && !is_mean) begin
            draws <= 1'b1;
            to_adder <= mode == NORMAL;
        end
    wire [15:0] set_up = in0[`IN0_triangles +: 16] * SET_UP;
    wire [15:0] begins = is_figure && !is_mean && set_up != 0 ? set_up : 16'd1;
    occupancy busy (.clk, .rst, .start, .cycles(!draws ? begins : is_dot ? INTERVAL : 16'd1), .free);
    // Control is delivered in the cycle of its start.
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 2)) to_52 (.clk, .rst, .put(out0_reserve), .data(draws ? pass0 : in0),
        .latency(draws ? LATENCY : 16'd0), .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 2)) to_28 (.clk, .rst, .put(out1_reserve), .data(pass1), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out1_push), .out(out1));
endmodule
`default_nettype wire
