// Largest whole number that is not above a number in single precision, as float and as integer. Combinational. Below 2^31.
`default_nettype none
module float_floor (input wire [31:0] x, output wire [31:0] whole, output wire signed [31:0] number, output wire has_fraction);
    wire [7:0] e = x[30:23];
    wire [54:0] fixed = {31'b0, e != 0, x[22:0]} << (e < 126 ? 0 : e - 8'd126);
    // Below 2^-1 all bits are fraction.
    wire [30:0] cut = e < 126 ? 31'd0 : fixed[54:24];
    assign has_fraction = e < 126 ? x[30:0] != 0 : fixed[23:0] != 0;
    wire [30:0] magnitude = cut + {30'b0, x[31] && has_fraction};
    assign number = x[31] ? -{1'b0, magnitude} : {1'b0, magnitude};
    float_round #(.W(31)) round (.sign(x[31] && magnitude != 0), .exponent(10'd157), .magnitude, .value(whole));
endmodule
`default_nettype wire
