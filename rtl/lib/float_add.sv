// Sum of two numbers in floating point, by default in single precision. Combinational. Infinities and NaN do not occur.
`default_nettype none
module float_add #(parameter E = 8, F = 23) (input wire [E+F:0] a, b, output wire [E+F:0] sum);
    localparam N = F + 4;
    wire swap = b[E+F-1:0] > a[E+F-1:0];
    wire [E+F:0] l = swap ? b : a, s = swap ? a : b;
    wire [E-1:0] le = l[F +: E] == 0 ? 1 : l[F +: E], se = s[F +: E] == 0 ? 1 : s[F +: E];
    wire [E-1:0] distance = le - se;
    wire [N-1:0] lm = {l[F +: E] != 0, l[F-1:0], 3'b0}, sm = {s[F +: E] != 0, s[F-1:0], 3'b0};
    // The smaller one, aligned, with a sticky bit.
    wire [2*N-1:0] wide = {sm, {N{1'b0}}} >> (distance > N ? N : distance);
    wire [N-1:0] aligned = {wide[2*N-1:N+1], wide[N:0] != 0};
    wire [N:0] total = l[E+F] == s[E+F] ? {1'b0, lm} + {1'b0, aligned} : {1'b0, lm} - {1'b0, aligned};
    wire sign = total == 0 ? a[E+F] && b[E+F] : l[E+F];
    float_round #(.E(E), .F(F), .W(N + 1)) round (.sign, .exponent({2'b0, le} + 1'b1), .magnitude(total), .value(sum));
endmodule
`default_nettype wire
