// Registers (14), (16) and (18) of JP H07-72915, Figure 1: mode, flatness, specular. The microcomputer (10) writes them, and a polygon that
// passes takes their values along.
`default_nettype none
module register_bank (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    output wire               start
);
    localparam FIGURE = 1;
    reg [1:0] mode;
    reg flat, specular;
    wire pass = in0[`IN0_pass];
    wire [4:0] register = in0[`IN0_register +: 5];
    assign start = in0_valid && out0_room;
    assign in0_pop = start;
    assign out0_reserve = start && pass;
    always @(posedge clk)
        if (rst) begin
            mode <= 0;
            flat <= 1'b0;
            specular <= 1'b0;
        end else if (start && !pass)
            case (register)
                14: mode <= in0[`IN0_value +: 2];
                16: flat <= in0[`IN0_value];
                default: specular <= in0[`IN0_value];
            endcase
    reg [`OUT0_W-1:0] result;
    always @* begin
        result = in0[`IN0_flow_kind +: `OUT0_W];
        if (in0[`IN0_flow_kind +: 2] == FIGURE) begin
            result[`OUT0_mode +: 2] = mode;
            result[`OUT0_flat] = flat;
            result[`OUT0_specular] = specular;
        end
    end
    delivery #(.W(`OUT0_W), .DEPTH(2)) deliver (.clk, .rst, .put(out0_reserve), .data(result), .latency(16'd1), .counts(1'b0),
        .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
