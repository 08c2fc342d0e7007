// Compares the blocks with Verilog's own arithmetic on random operands: iverilog -g2012 -o check check.v blocks.v roms.v && ./check
module check;
  reg clk = 0; always #1 clk = ~clk;
  integer n, bad = 0; reg [31:0] a, b; reg start = 0;
  wire [15:0] q, r; wire busy; div_seq #(.W(16), .K(4), .C(3)) d(clk, start, a[15:0], b[15:0], q, r, busy);
  wire [7:0] s; sqrt_comb #(.W(16)) sc(a[15:0], s); wire [11:0] t; wire busy2; sqrt_seq #(.W(24), .K(2), .C(4)) ss(clk, start, a[23:0], t, busy2);
  wire [31:0] m, p; fmul fm(a, b, m); fadd fa(a, b, p);
  wire [33:0] y; wire [2:0] k; reg [271:0] v; max_tree #(.N(8), .W(34), .I(3)) mt(v, y, k);
  wire [7:0] g; prio #(.N(8)) pr(a[7:0], g);
  reg [7:0] age = 8'b11_10_01_00; wire [7:0] age2; wire [1:0] old; lru #(.N(4), .B(2)) l(age, a[1:0], age2, old);
  reg [15:0] x; reg [15:0] e; wire [15:0] w; power #(.A(6)) po(x, e, w);
  wire [15:0] w2; wire busy3; power_seq #(.A(6), .K(4), .C(3)) ps(clk, start, x, e, w2, busy3);
  function real f(input [31:0] z); f = (z[30:23] == 0) ? 0.0 : (z[31] ? -1.0 : 1.0) * (1.0 + z[22:0] / 8388608.0) * 2.0 ** ($signed({1'b0, z[30:23]}) - 127); endfunction
  function near(input real u, v, scale); real d; begin d = u - v; if (d < 0) d = -d; near = d <= 3.0e-7 * scale; end endfunction
  function real mag(input real u); mag = u < 0 ? -u : u; endfunction
  real worst = 0, got, want; integer i, best;
  initial begin
    for (n = 0; n < 20000; n = n + 1) begin
      a = $urandom; b = $urandom; if (b[15:0] == 0) b = 1; a[30:23] = 100 + a[30:23] % 50; b[30:23] = n % 3 ? 100 + b[30:23] % 50 : a[30:23];
      for (i = 0; i < 9; i = i + 1) v[i*32 +: 32] = $urandom;
      @(negedge clk) start = 1; @(negedge clk) start = 0; while (busy | busy2) @(negedge clk);
      if (q != a[15:0] / b[15:0] || r != a[15:0] % b[15:0]) begin if (bad < 5) $display("div %d / %d = %d r %d", a[15:0], b[15:0], q, r); bad = bad + 1; end
      if (s * s > a[15:0] || (s + 1) * (s + 1) <= a[15:0]) begin if (bad < 5) $display("sqrt %d", a[15:0]); bad = bad + 1; end
      if (t * t > a[23:0] || (t + 1) * (t + 1) <= a[23:0]) begin if (bad < 5) $display("sqrt_seq %d = %d", a[23:0], t); bad = bad + 1; end
      if (!near(f(m), f(a) * f(b), mag(f(a) * f(b)))) begin if (bad < 5) $display("fmul %g * %g = %g", f(a), f(b), f(m)); bad = bad + 1; end
      if (!near(f(p), f(a) + f(b), mag(f(a)) + mag(f(b)))) begin if (bad < 5) $display("fadd %g + %g = %g", f(a), f(b), f(p)); bad = bad + 1; end
      best = 0; for (i = 1; i < 8; i = i + 1) if ($signed(v[i*34 +: 34]) > $signed(v[best*34 +: 34])) best = i;
      if (k != best || y != v[best*34 +: 34]) begin if (bad < 5) $display("max"); bad = bad + 1; end
      if (g != (a[7:0] & (~a[7:0] + 8'd1))) bad = bad + 1;
      age = age2; if (age[1:0] + age[3:2] + age[5:4] + age[7:6] != 6 || age[a[1:0]*2 +: 2] != 0) begin if (bad < 5) $display("lru %b", age); bad = bad + 1; end
      x = 16'h8000 | a[15:0]; e = 16'd256 + b[13:0];
      @(negedge clk) start = 1; @(negedge clk) start = 0; while (busy3) @(negedge clk);
      if (w2 != w) begin if (bad < 5) $display("power %d ^ %d = %d", x, e, w2); bad = bad + 1; end
      got = w / 65536.0; want = (x / 65536.0) ** (e / 256.0); if (mag(got - want) > worst) worst = mag(got - want);
    end
    $display("20000 operands, %0d wrong; power: largest error %f", bad, worst); $finish;
  end
endmodule
