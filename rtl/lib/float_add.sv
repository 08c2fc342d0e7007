// Sum of two numbers in single precision, rounded to nearest, ties to even. Combinational. Infinities and NaN do not occur.
`default_nettype none
module float_add (input wire [31:0] a, b, output wire [31:0] sum);
    wire swap = b[30:0] > a[30:0];
    wire [31:0] l = swap ? b : a, s = swap ? a : b;
    wire [7:0] le = l[30:23] == 0 ? 8'd1 : l[30:23], se = s[30:23] == 0 ? 8'd1 : s[30:23];
    wire [7:0] distance = le - se;
    wire [26:0] lm = {l[30:23] != 0, l[22:0], 3'b0}, sm = {s[30:23] != 0, s[22:0], 3'b0};
    // The smaller one, aligned, with a sticky bit.
    wire [53:0] wide = {sm, 27'b0} >> (distance > 27 ? 8'd27 : distance);
    wire [26:0] aligned = {wide[53:28], wide[27] || wide[26:0] != 0};
    wire [27:0] total = l[31] == s[31] ? {1'b0, lm} + {1'b0, aligned} : {1'b0, lm} - {1'b0, aligned};
    reg [27:0] m;
    reg [8:0] e;
    reg [24:0] rounded;
    reg [4:0] zeros, shift;
    integer i;
    always @* begin
        m = total;
        e = {1'b0, le};
        if (m[27]) begin
            m = {1'b0, m[27:2], m[1] || m[0]};
            e = e + 9'd1;
        end
        // Leading zeros, up to the smallest exponent.
        zeros = 0;
        for (i = 0; i < 27; i = i + 1)
            if (m[i]) zeros = 26 - i;
        shift = {4'b0, zeros} < e ? zeros : e[4:0] - 5'd1;
        m = m << shift;
        e = e - shift;
        rounded = {1'b0, m[26:3]} + {24'b0, m[2] && (m[1] || m[0] || m[3])};
        if (rounded[24]) begin
            rounded = {1'b0, rounded[24:1]};
            e = e + 9'd1;
        end
    end
    assign sum = total == 0 ? {a[31] && b[31], 31'b0} : {l[31], rounded[23] ? e[7:0] : 8'd0, rounded[22:0]};
endmodule
`default_nettype wire
