// Inner product of two vectors of three signed components, or 0 if it is not needed in this cycle. Combinational.
`default_nettype none
module inner_product #(parameter W = 16) (input wire enable, input wire [3*W-1:0] a, b, output wire signed [2*W+1:0] product);
    wire signed [2*W-1:0] x, y, z;
    multiply #(.W(W)) of_x (.enable, .a(a[0 +: W]), .b(b[0 +: W]), .product(x));
    multiply #(.W(W)) of_y (.enable, .a(a[W +: W]), .b(b[W +: W]), .product(y));
    multiply #(.W(W)) of_z (.enable, .a(a[2*W +: W]), .b(b[2*W +: W]), .product(z));
    assign product = x + y + z;
endmodule
`default_nettype wire
