// A component of a texture value times one of the illuminance, as a byte: halves round up, and the result saturates. Combinational.
`default_nettype none
module modulate #(parameter W = 16, ONE = 22) (input wire [W-1:0] texture, illuminance, output wire [7:0] value);
    wire [2*W:0] product = texture * illuminance + ({{2*W{1'b0}}, 1'b1} << (ONE - 1));
    assign value = product[2*W:ONE+8] != 0 ? 8'd255 : product[ONE +: 8];
endmodule
`default_nettype wire
