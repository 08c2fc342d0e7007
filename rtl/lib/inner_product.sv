// Inner product of two vectors of three signed components, or 0 if it is not needed in this cycle. Combinational.
`default_nettype none
module inner_product #(parameter W = 16) (input wire enable, input wire [3*W-1:0] a, b, output reg signed [2*W+1:0] product);
    always @*
        if (enable) product = $signed(a[0 +: W]) * $signed(b[0 +: W]) + $signed(a[W +: W]) * $signed(b[W +: W])
            + $signed(a[2*W +: W]) * $signed(b[2*W +: W]);
        else product = 0;
endmodule
`default_nettype wire
