// A component of a colour as a byte: c * 255 + 0.5 in single precision, cut to 0 ..= 255. Combinational.
`default_nettype none
module float_to_byte (input wire [31:0] c, output wire [7:0] value);
    wire [7:0] e = c[30:23] == 0 ? 8'd1 : c[30:23];
    wire [31:0] product = {c[30:23] != 0, c[22:0], 8'b0} - {8'b0, c[30:23] != 0, c[22:0]}, scaled, sum;
    float_round #(.W(32)) round (.sign(c[31]), .exponent({2'b0, e} + 10'd8), .magnitude(product), .value(scaled));
    float_add add (.a(scaled), .b(32'h3f000000), .sum);
    // 2^7 ..= 2^8 - 1 has the exponent 134.
    wire [31:0] whole = {8'b0, 1'b1, sum[22:0]} >> (8'd150 - sum[30:23]);
    assign value = sum[31] || sum[30:23] < 127 ? 8'd0 : c[30:23] > 127 || sum[30:23] > 134 ? 8'd255 : whole[7:0];
endmodule
`default_nettype wire
