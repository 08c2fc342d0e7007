// Product of two signed numbers, or 0 if it is not needed in this cycle. Combinational.
`default_nettype none
module multiply #(parameter W = 16) (input wire enable, input wire [W-1:0] a, b, output reg signed [2*W-1:0] product);
    always @*
        if (enable) product = $signed(a) * $signed(b);
        else product = 0;
endmodule
`default_nettype wire
