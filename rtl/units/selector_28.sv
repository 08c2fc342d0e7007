// Selector (28) of JP H07-72915, Figure 1, the output of the device: selects selector (53), circuit (21) or process 24 by mode, and saturates.
//
// Input 0 comes from selector (53) and carries control, input 1 from circuit (21), input 2 from process 24. Output 0 carries stamps of one
// pixel to the frame memory (300). Output 1 reports each finished polygon to the host interface.
`default_nettype none
module selector_28 #(parameter INTERVAL = 1, LATENCY = 1) (
    input  wire               clk, rst,
    input  wire               in0_valid, in1_valid, in2_valid,
    input  wire [`IN0_W-1:0]  in0, in1, in2,
    output wire               in0_pop, in1_pop, in2_pop,
    input  wire               out0_room, out1_room,
    output wire               out0_reserve, out0_push, out1_reserve, out1_push,
    output wire [`OUT0_W-1:0] out0,
    output wire [`OUT1_W-1:0] out1,
    output wire               start
);
    localparam FRAME = 0, FIGURE = 1, DOT = 2, END = 3, NORMAL = 0, POLYHEDRON = 2;
    localparam FROM_53 = 0, FROM_21 = 1, FROM_24 = 2;
    wire free;
    reg [1:0] selected;
    wire [`IN0_W-1:0] token = selected == FROM_53 ? in0 : selected == FROM_21 ? in1 : in2;
    wire [1:0] kind = token[`IN0_kind +: 2];
    wire ends = kind == END && !token[`IN0_frame_end];
    wire valid = selected == FROM_53 ? in0_valid : selected == FROM_21 ? in1_valid : in2_valid;
    assign start = free && valid && out0_room && out1_room;
    assign in0_pop = start && selected == FROM_53;
    assign in1_pop = start && selected == FROM_21;
    assign in2_pop = start && selected == FROM_24;
    assign out0_reserve = start && kind != FIGURE && !ends;
    assign out1_reserve = start && ends;
    wire [1:0] mode = token[`IN0_mode +: 2];
    wire is_mean = mode == POLYHEDRON || token[`IN0_flat];
    always @(posedge clk)
        if (rst) selected <= FROM_53;
        else if (start && kind == FIGURE) selected <= mode == NORMAL ? FROM_53 : is_mean ? FROM_24 : FROM_21;
        else if (start && ends) selected <= FROM_53;
    wire [7:0] red, green, blue;
    float_to_byte to_red (.c(token[`IN0_red +: 32]), .value(red));
    float_to_byte to_green (.c(token[`IN0_green +: 32]), .value(green));
    float_to_byte to_blue (.c(token[`IN0_blue +: 32]), .value(blue));
    reg [`OUT0_W-1:0] result;
    always @* begin
        result = 0;
        if (kind == DOT) begin
            result[`OUT0_item] = 1'b1;
            result[`OUT0_count] = 1'b1;
            result[`OUT0_0_x +: 16] = token[`IN0_x +: 16];
            result[`OUT0_0_y +: 16] = token[`IN0_y +: 16];
            result[`OUT0_0_z +: `OUT0_0_z_N] = token[`IN0_z +: `IN0_z_N];
            result[`OUT0_0_rgb +: 24] = {blue, green, red};
        end else begin
            result[`OUT0_kind +: 3] = kind == FRAME ? 3'd0 : 3'd4;
            result[`OUT0_number +: 29] = token[`IN0_number +: 29];
            result[`OUT0_width +: 16] = token[`IN0_width +: 16];
            result[`OUT0_height +: 16] = token[`IN0_height +: 16];
        end
    end
    occupancy busy (.clk, .rst, .start, .cycles(kind == DOT ? INTERVAL : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 1)) deliver (.clk, .rst, .put(out0_reserve), .data(result), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
    delivery #(.W(`OUT1_W), .DEPTH(LATENCY + 1)) finish (.clk, .rst, .put(out1_reserve), .data(1'b1), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out1_push), .out(out1));
endmodule
`default_nettype wire
