// Counts the cycles for which a step occupies its unit (law 3). A step of one cycle leaves the unit free for the next cycle.
`default_nettype none
module occupancy #(parameter W = 16) (
    input  wire         clk, rst,
    input  wire         start,
    input  wire [W-1:0] cycles,
    output wire         free
);
    reg [W-1:0] left;
    assign free = left == 0;
    always @(posedge clk)
        if (rst) left <= 0;
        else if (start) left <= cycles == 0 ? {W{1'b0}} : cycles - 1'b1;
        else if (!free) left <= left - 1'b1;
endmodule
`default_nettype wire
