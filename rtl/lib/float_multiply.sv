// Product of two numbers in floating point, by default in single precision. Combinational. Infinities and NaN do not occur.
`default_nettype none
module float_multiply #(parameter E = 8, F = 23) (input wire [E+F:0] a, b, output wire [E+F:0] product);
    localparam [E+1:0] BIAS = (1 << (E - 1)) - 1;
    wire [E+1:0] ea = a[F +: E] == 0 ? 1 : a[F +: E], eb = b[F +: E] == 0 ? 1 : b[F +: E];
    wire [2*F+1:0] magnitude = {a[F +: E] != 0, a[F-1:0]} * {b[F +: E] != 0, b[F-1:0]};
    float_round #(.E(E), .F(F), .W(2 * F + 2), .UNDERFLOWS(1)) round (.sign(a[E+F] ^ b[E+F]), .exponent(ea + eb - BIAS + 1'b1), .magnitude,
        .value(product));
endmodule
`default_nettype wire
