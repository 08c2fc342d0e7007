// Number in floating point with E bits of exponent and F of fraction, normalized and rounded to nearest, ties to even. Combinational.
//
// `exponent` belongs to the highest bit of `magnitude`. It is at least 1 unless UNDERFLOWS. Infinities and NaN do not occur.
`default_nettype none
module float_round #(parameter E = 8, F = 23, W = 28, UNDERFLOWS = 0) (
    input  wire                sign,
    input  wire signed [E+1:0] exponent,
    input  wire [W-1:0]        magnitude,
    output wire [E+F:0]        value
);
    localparam S = $clog2(W) + 1;
    reg [W-1:0] m;
    reg signed [E+1:0] e;
    reg [S-1:0] zeros, shift;
    reg [F+1:0] rounded;
    wire [2*W-1:0] shifted;
    generate
        // A number below the smallest exponent moves right, with a sticky bit.
        if (UNDERFLOWS) begin : underflow
            wire [E+1:0] distance = 1 - exponent;
            assign shifted = {magnitude, {W{1'b0}}} >> (distance > W ? W : distance);
        end else assign shifted = 0;
    endgenerate
    integer i;
    always @* begin
        m = magnitude;
        e = exponent;
        if (UNDERFLOWS && exponent < 1) begin
            m = {shifted[2*W-1:W+1], shifted[W:0] != 0};
            e = 1;
        end
        // Leading zeros, up to the smallest exponent.
        zeros = W - 1;
        for (i = 0; i < W; i = i + 1)
            if (m[i]) zeros = W - 1 - i;
        shift = $signed({1'b0, zeros}) < e ? zeros : e[S-1:0] - 1'b1;
        m = m << shift;
        e = e - $signed({1'b0, shift});
        rounded = {1'b0, m[W-1:W-F-1]} + {{(F+1){1'b0}}, m[W-F-2] && (m[W-F-1] || m[W-F-3:0] != 0)};
        if (rounded[F+1]) begin
            rounded = {1'b0, rounded[F+1:1]};
            e = e + 1'b1;
        end
    end
    assign value = {sign, rounded[F] ? e[E-1:0] : {E{1'b0}}, rounded[F-1:0]};
endmodule
`default_nettype wire
