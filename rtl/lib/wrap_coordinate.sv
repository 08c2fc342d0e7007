// Texture coordinate (312) wrapped into the texture, 0 ..= size texels, in single precision. `inverse` is that of `size`. Combinational.
`default_nettype none
module wrap_coordinate (input wire [31:0] s, size, inverse, input wire [1:0] mode, output wire [31:0] place);
    localparam REPEAT = 0, MIRROR = 1;
    localparam [31:0] EXPONENT = 32'h00800000, SIGN = 32'h80000000;
    wire mirrors = mode == MIRROR;
    // Two textures side by side repeat if the second is mirrored.
    wire [31:0] period = mirrors ? size + EXPONENT : size, half = s[30:23] > 1 ? s - EXPONENT : s;
    wire [31:0] quotient, copies, whole, rest, corrected, wrapped, lower;
    float_multiply divide (.a(mirrors ? half : s), .b(inverse), .product(quotient));
    float_floor of_copies (.x(quotient), .whole(copies), .number(), .has_fraction());
    float_multiply of_whole (.a(period), .b(copies), .product(whole));
    float_add subtract (.a(s), .b(whole ^ SIGN), .sum(rest));
    // The quotient is rounded, so the rest may be off by one texture.
    wire is_below = rest[31] && rest[30:0] != 0, is_above = !rest[31] && rest[30:0] > size[30:0];
    float_add correct (.a(mirrors ? period : rest), .b(mirrors ? rest ^ SIGN : size), .sum(corrected));
    assign wrapped = (mirrors ? is_above : is_below) ? corrected : rest;
    float_add reduce (.a(wrapped), .b(size ^ SIGN), .sum(lower));
    wire [31:0] found = mode == REPEAT && !wrapped[31] && wrapped[30:0] >= size[30:0] ? lower : mirrors || mode == REPEAT ? wrapped : s;
    assign place = found[31] || found[30:0] == 0 ? 32'd0 : found[30:0] < size[30:0] ? found : size;
endmodule
`default_nettype wire
