// A component of a colour as a byte: c * 255 + 0.5 in single precision, cut to 0 ..= 255. Combinational.
`default_nettype none
module float_to_byte (input wire [31:0] c, output wire [7:0] value);
    wire [7:0] e = c[30:23] == 0 ? 8'd1 : c[30:23];
    wire [31:0] product = {8'b0, c[30:23] != 0, c[22:0]} * 32'd255;
    // The product of 24 and 8 bits, rounded to 24 bits.
    reg [31:0] m;
    reg [8:0] pe;
    reg [24:0] rounded;
    reg [4:0] zeros, shift;
    integer i;
    always @* begin
        m = product;
        pe = {1'b0, e} + 9'd8;
        zeros = 31;
        for (i = 0; i < 32; i = i + 1)
            if (m[i]) zeros = 31 - i;
        shift = {4'b0, zeros} < pe ? zeros : pe[4:0] - 5'd1;
        m = m << shift;
        pe = pe - shift;
        rounded = {1'b0, m[31:8]} + {24'b0, m[7] && (m[6:0] != 0 || m[8])};
        if (rounded[24]) begin
            rounded = {1'b0, rounded[24:1]};
            pe = pe + 9'd1;
        end
    end
    wire [31:0] scaled = {c[31], rounded[23] ? pe[7:0] : 8'd0, rounded[22:0]}, sum;
    float_add add (.a(scaled), .b(32'h3f000000), .sum(sum));
    // 2^7 ..= 2^8 - 1 has the exponent 134.
    wire [31:0] whole = {8'b0, 1'b1, sum[22:0]} >> (8'd150 - sum[30:23]);
    assign value = sum[31] || sum[30:23] < 127 ? 8'd0 : pe > 9'd134 || sum[30:23] > 134 ? 8'd255 : whole[7:0];
endmodule
`default_nettype wire
