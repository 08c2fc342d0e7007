// Normal-interpolation brightness circuit (50) of JP H07-72915, Figure 1: Ks times the sum of Is (N.H)^n for every dot, equation (12).
//
// The power is computed by iteration: a squaring for each binary digit of n but the first, and a product for each one. Each light occupies the
// circuit for the time of its power, because `normal_interpolation.pipelined` is false. Timing twin: dots are in floating point, so the bench
// passes them in (`pass0`).
`default_nettype none
module normal_interpolation #(parameter SET_UP = 1, FIXED = 1, SUM = 1, MULTIPLY = 1, PRODUCTS = 1, NORMALISE = 1) (
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
    localparam BEGIN = 1, DOT = 2;
    wire free;
    reg draws;
    reg [15:0] dot_cycles, dot_latency;
    wire is_dot = pass0[`OUT0_kind +: 2] == DOT;
    assign start = free && (draws || in0_valid) && out0_room;
    assign in0_pop = start && !draws;
    assign out0_reserve = start;
    // The exponent n, rounded up to a whole number of 1 ..= 65536, from single precision.
    wire [31:0] n = in0[`IN0_exponent +: 32];
    wire [47:0] fixed = {24'b0, 1'b1, n[22:0]} << (n[30:23] - 8'd127);
    wire [16:0] whole = n[31] || n[30:23] < 127 ? 17'd1 : n[30:23] > 142 ? 17'd65536 : fixed[39:23] + {16'd0, fixed[22:0] != 0};
    reg [15:0] multiplications;
    integer i;
    always @* begin
        multiplications = 0;
        for (i = 0; i < 17; i = i + 1)
            if (whole >> i > 1) multiplications = multiplications + 16'd1 + whole[i];
    end
    wire [15:0] lights = in0[`IN0_lights +: 16] == 0 ? 16'd1 : in0[`IN0_lights +: 16];
    wire [15:0] power_latency = multiplications * MULTIPLY;
    wire [15:0] power = power_latency > PRODUCTS ? power_latency : PRODUCTS;
    wire [15:0] all = power * lights, set_up = in0[`IN0_triangles +: 16] * SET_UP;
    always @(posedge clk)
        if (rst) draws <= 1'b0;
        else if (start && draws) draws <= is_dot;
        else if (start) begin
            draws <= 1'b1;
            dot_cycles <= all > NORMALISE ? all : NORMALISE;
            dot_latency <= FIXED + power_latency + power * (lights - 16'd1) + (lights > 1 ? SUM : 0);
        end
    reg [`OUT0_W-1:0] begins;
    always @* begin
        begins = 0;
        begins[`OUT0_kind +: 2] = BEGIN;
        begins[`OUT0_open] = in0[`IN0_open];
    end
    occupancy busy (.clk, .rst, .start, .cycles(!draws ? set_up : is_dot ? dot_cycles : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(start), .data(draws ? pass0 : begins),
        .latency(draws ? dot_latency : 16'd0), .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
