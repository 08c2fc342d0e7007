// Blocks whose area measure.py measures. Their ports are flat, so that yosys 0.23 reads them.
// SPDX-License-Identifier: MIT OR Apache-2.0
module mul_s #(parameter W = 8, V = 8)(input signed [W-1:0] a, input signed [V-1:0] b, output signed [W+V-1:0] y); assign y = a * b; endmodule
module mul_u #(parameter W = 8, V = 8)(input [W-1:0] a, input [V-1:0] b, output [W+V-1:0] y); assign y = a * b; endmodule
// Product cut to the upper half, as fixed-point operators hand it on.
module mul_h #(parameter W = 8)(input signed [W-1:0] a, b, output [W-1:0] y); wire signed [2*W-1:0] p = a * b; assign y = p[2*W-1:W]; endmodule
module add #(parameter W = 8)(input [W-1:0] a, b, output [W:0] y); assign y = a + b; endmodule
module sub #(parameter W = 8)(input [W-1:0] a, b, output [W:0] y); assign y = a - b; endmodule
module addsub #(parameter W = 8)(input [W-1:0] a, b, input s, output [W-1:0] y); assign y = s ? a - b : a + b; endmodule
module inc #(parameter W = 8)(input [W-1:0] a, output [W-1:0] y); assign y = a + 1'b1; endmodule
module lt_u #(parameter W = 8)(input [W-1:0] a, b, output y); assign y = a < b; endmodule
module lt_s #(parameter W = 8)(input signed [W-1:0] a, b, output y); assign y = a < b; endmodule
module eq #(parameter W = 8)(input [W-1:0] a, b, output y); assign y = a == b; endmodule
module max2 #(parameter W = 34, I = 6)(input signed [W-1:0] a, b, input [I-1:0] i, j, output signed [W-1:0] y, output [I-1:0] k);
  wire s = b > a; assign y = s ? b : a; assign k = s ? j : i;
endmodule
module shr #(parameter W = 8, S = 3)(input [W-1:0] a, input [S-1:0] n, output [W-1:0] y); assign y = a >> n; endmodule
module sra #(parameter W = 8, S = 3)(input signed [W-1:0] a, input [S-1:0] n, output signed [W-1:0] y); assign y = a >>> n; endmodule
module mux #(parameter W = 8, N = 4, S = 2)(input [N*W-1:0] a, input [S-1:0] s, output [W-1:0] y); assign y = a[s*W +: W]; endmodule
// Select lines already decoded: AND-OR.
module onehot_mux #(parameter W = 8, N = 4)(input [N*W-1:0] a, input [N-1:0] s, output reg [W-1:0] y);
  integer i; always @* begin y = 0; for (i = 0; i < N; i = i + 1) y = y | (a[i*W +: W] & {W{s[i]}}); end
endmodule
module prio #(parameter N = 8)(input [N-1:0] r, output [N-1:0] g); assign g = r & -r; endmodule
module dff #(parameter W = 8)(input clk, input [W-1:0] d, output reg [W-1:0] q); always @(posedge clk) q <= d; endmodule
module dffe #(parameter W = 8)(input clk, e, input [W-1:0] d, output reg [W-1:0] q); always @(posedge clk) if (e) q <= d; endmodule
module dffr #(parameter W = 8)(input clk, rst, input [W-1:0] d, output reg [W-1:0] q); always @(posedge clk) if (rst) q <= 0; else q <= d; endmodule
// FIFO without its words: a slot is reserved, filled later, taken.
module fifo_control #(parameter DEPTH = 16, A = 4)(input clk, rst, reserve, push, pop, output room, valid, output [A-1:0] wa, ra);
  reg [A-1:0] wp, rp; reg [A:0] held, filled;
  assign room = held != DEPTH; assign valid = filled != 0; assign wa = wp; assign ra = rp;
  always @(posedge clk) if (rst) begin wp <= 0; rp <= 0; held <= 0; filled <= 0; end else begin
    if (push) wp <= wp + 1'b1; if (pop) rp <= rp + 1'b1; held <= held + reserve - pop; filled <= filled + push - pop; end
endmodule
// Words in flip-flops: one write port, R read ports.
module regfile #(parameter D = 16, W = 16, R = 1, A = 4)(input clk, we, input [A-1:0] wa, input [W-1:0] d, input [R*A-1:0] ra, output [R*W-1:0] q);
  reg [W-1:0] m[0:D-1]; genvar g;
  always @(posedge clk) if (we) m[wa] <= d;
  generate for (g = 0; g < R; g = g + 1) assign q[g*W +: W] = m[ra[g*A +: A]]; endgenerate
endmodule
// Several write ports in turn: the last one wins.
module regfile_w #(parameter D = 16, W = 16, P = 2, A = 4)(input clk, input [P-1:0] we, input [P*A-1:0] wa, input [P*W-1:0] d, input [A-1:0] ra, output [W-1:0] q);
  reg [W-1:0] m[0:D-1]; integer i;
  always @(posedge clk) for (i = 0; i < P; i = i + 1) if (we[i]) m[wa[i*A +: A]] <= d[i*W +: W];
  assign q = m[ra];
endmodule
// A look-up: N tags of T bits against one address; hit and the line of the way, L bits.
module tagcmp #(parameter T = 20, N = 4, L = 1)(input [N*T-1:0] tags, input [N-1:0] valid, input [T-1:0] a, input [N*L-1:0] d, output [N-1:0] h, output hit, output reg [L-1:0] q);
  genvar g; integer i;
  generate for (g = 0; g < N; g = g + 1) assign h[g] = valid[g] & (tags[g*T +: T] == a); endgenerate
  assign hit = |h; always @* begin q = 0; for (i = 0; i < N; i = i + 1) q = q | (d[i*L +: L] & {L{h[i]}}); end
endmodule
// Age of each way of a set, 0 = used last; what a use of way u makes of it, and the oldest.
module lru #(parameter N = 4, B = 2)(input [N*B-1:0] age, input [B-1:0] u, output reg [N*B-1:0] next, output reg [B-1:0] oldest);
  integer i; wire [B-1:0] was = age[u*B +: B];
  always @* begin oldest = 0; for (i = 0; i < N; i = i + 1) begin
    next[i*B +: B] = i == u ? {B{1'b0}} : age[i*B +: B] < was ? age[i*B +: B] + 1'b1 : age[i*B +: B];
    if (age[i*B +: B] == N-1) oldest = i; end end
endmodule
// Restoring division, K bits of the quotient per cycle; W by W bits.
module div_seq #(parameter W = 16, K = 1, C = 5)(input clk, start, input [W-1:0] n, d, output reg [W-1:0] q, output reg [W-1:0] r, output busy);
  reg [W-1:0] den; reg [C-1:0] c; reg [W:0] x; reg [W-1:0] y; integer i;
  always @* begin x = {1'b0, r}; y = q; for (i = 0; i < K; i = i + 1) begin
    x = {x[W-1:0], y[W-1]}; y = {y[W-2:0], 1'b0}; if (x >= {1'b0, den}) begin x = x - {1'b0, den}; y[0] = 1; end end end
  assign busy = c != 0;
  always @(posedge clk) if (start) begin q <= n; den <= d; r <= 0; c <= (W + K - 1) / K; end else if (busy) begin q <= y; r <= x[W-1:0]; c <= c - 1'b1; end
endmodule
// Root of W bits (W even), all bits at once.
module sqrt_comb #(parameter W = 16)(input [W-1:0] a, output reg [W/2-1:0] q);
  reg [W/2+1:0] r, t; integer i;
  always @* begin q = 0; r = 0; for (i = W/2-1; i >= 0; i = i - 1) begin
    r = {r[W/2-1:0], a[2*i +: 2]}; t = {q, 2'b01}; q = {q[W/2-2:0], 1'b0}; if (r >= t) begin r = r - t; q[0] = 1; end end end
endmodule
// The same, K bits of the root per cycle.
module sqrt_seq #(parameter W = 16, K = 1, C = 5)(input clk, start, input [W-1:0] a, output reg [W/2-1:0] q, output busy);
  reg [W-1:0] n, m; reg [W/2+1:0] r, x, t; reg [W/2-1:0] y; reg [C-1:0] c; integer i;
  always @* begin x = r; y = q; m = n; for (i = 0; i < K; i = i + 1) begin
    x = {x[W/2-1:0], m[W-1:W-2]}; m = {m[W-3:0], 2'b00}; t = {y, 2'b01}; y = {y[W/2-2:0], 1'b0}; if (x >= t) begin x = x - t; y[0] = 1; end end end
  assign busy = c != 0;
  always @(posedge clk) if (start) begin n <= a; r <= 0; q <= 0; c <= (W/2 + K - 1) / K; end else if (busy) begin n <= m; r <= x; q <= y; c <= c - 1'b1; end
endmodule
// Floating point like float32: E bits of exponent, M of fraction, hidden one; no denormals, no NaN, cut off instead of rounded.
module fmul #(parameter E = 8, M = 23)(input [E+M:0] a, b, output [E+M:0] y);
  wire [2*M+1:0] p = {1'b1, a[M-1:0]} * {1'b1, b[M-1:0]}; wire h = p[2*M+1];
  wire [E+1:0] e = a[M +: E] + b[M +: E] + h - ((1 << (E-1)) - 1); wire zero = a[M +: E] == 0 || b[M +: E] == 0 || e[E+1];
  assign y = {a[E+M] ^ b[E+M], zero ? {(E+M){1'b0}} : e[E] ? {{E{1'b1}}, {M{1'b0}}} : {e[E-1:0], h ? p[2*M -: M] : p[2*M-1 -: M]}};
endmodule
module fadd #(parameter E = 8, M = 23, S = 5)(input [E+M:0] a, b, output [E+M:0] y);
  wire less = a[E+M-1:0] < b[E+M-1:0]; wire [E+M:0] p = less ? b : a, q = less ? a : b;
  wire [E-1:0] d = p[M +: E] - q[M +: E]; wire far = |d[E-1:S];
  wire [M+1:0] u = {1'b1, p[M-1:0], 1'b0}; wire [M+1:0] v = far ? 0 : {1'b1, q[M-1:0], 1'b0} >> d[S-1:0];
  wire [M+2:0] s = a[E+M] == b[E+M] ? u + v : u - v;
  reg [S-1:0] z; integer i; always @* begin z = 0; for (i = 0; i <= M + 2; i = i + 1) if (s[i]) z = M + 2 - i; end
  wire [M+2:0] n = s << z; wire [E+1:0] e = p[M +: E] + 1'b1 - z;
  assign y = {p[E+M], s == 0 || e[E+1] ? {(E+M){1'b0}} : {e[E-1:0], n[M+1:2]}};
endmodule
// Inner product of three, and the largest of N with its place (balanced tree, below).
module dot3 #(parameter W = 16)(input signed [W-1:0] a, b, c, x, y, z, output signed [2*W+1:0] d); assign d = a * x + b * y + c * z; endmodule
module max_tree #(parameter N = 8, W = 34, I = 3)(input [N*W-1:0] v, output [W-1:0] y, output [I-1:0] k);
  generate if (N == 1) begin assign y = v; assign k = 0; end else begin
    wire [W-1:0] a, b; wire [I-1:0] i, j; wire s = $signed(b) > $signed(a);
    max_tree #(.N(N/2), .W(W), .I(I)) l(.v(v[N/2*W-1:0]), .y(a), .k(i)); max_tree #(.N(N/2), .W(W), .I(I)) h(.v(v[N*W-1:N/2*W]), .y(b), .k(j));
    assign y = s ? b : a; assign k = s ? j | N/2 : i; end endgenerate
endmodule
// Power x^n, x of 16 bits below 1, n with 8 bits behind the point: table of logarithms, interpolated; product with the exponent;
// table of powers of two, interpolated; shift.
module power #(parameter A = 6)(input [15:0] x, input [15:0] n, output [15:0] y);
  wire [31:0] l, p, e; rom_log #(.A(A)) tl(x[15 -: A], l); rom_exp #(.A(A)) te(e[19 -: A], p);
  wire [31:0] dl = l[15:0] * x[15-A:0], dp = p[15:0] * e[19-A -: 10];
  wire [15:0] lg = l[31:16] - (dl >> (16 - A)); assign e = lg * n; wire [15:0] m = p[31:16] - (dp >> 10);
  assign y = |e[31:24] ? 16'd0 : m >> e[23:20];
endmodule
// The same power, K digits of a factor per cycle: its three products take turns in one multiplier of 16 by K bits.
module power_seq #(parameter A = 6, K = 2, C = 4)(input clk, start, input [15:0] x, input [15:0] n, output [15:0] y, output busy);
  reg [1:0] t; reg [C-1:0] c; reg [31:0] p; reg [15:0] a, v, m; reg [3:0] s; reg none;
  wire [31:0] l, e; rom_log #(.A(A)) tl(x[15 -: A], l); rom_exp #(.A(A)) te(p[19 -: A], e);
  wire [15+K:0] sum = p[31:16] + a * p[K-1:0]; wire [15:0] between = v - p[16-A +: 16];
  assign busy = t != 0; assign y = none ? 16'd0 : between >> s;
  always @(posedge clk)
    if (start) begin t <= 3; c <= 16 / K; a <= l[15:0]; v <= l[31:16]; p <= x[15-A:0]; m <= n; none <= 0; s <= 0; end
    else if (c != 0) begin c <= c - 1'b1; p <= {sum, p[15:0]} >> K; end
    else if (t == 3) begin t <= 2; c <= 16 / K; a <= m; p <= between; end
    else if (t == 2) begin t <= 1; c <= 16 / K; a <= e[15:0]; v <= e[31:16]; p <= p[19-A -: 10]; s <= p[23:20]; none <= |p[31:24]; end
    else t <= 0;
endmodule
