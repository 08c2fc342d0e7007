// Depth comparison: true if a fragment is in front of the z-buffer. Combinational.
`default_nettype none
module nearer #(parameter Z = 24) (input wire [Z-1:0] fragment, stored, output wire passes);
    assign passes = fragment < stored;
endmodule
`default_nettype wire
