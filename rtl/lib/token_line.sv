// The first pixel of a token that lies in the picture, and the number of its pixels. Of a packet it is the first column and row.
`default_nettype none
module token_line #(parameter PACKETS = 0) (
    input  wire [`IN0_W-1:0] token,
    input  wire [15:0]       width, height,
    output reg               any,
    output reg  [15:0]       x, y, pixels
);
    integer p;
`ifdef IN0_STAMP
    always @* begin
        any = 1'b0;
        x = 0;
        y = 0;
        pixels = token[`IN0_count +: `IN0_count_N];
        for (p = `IN0_STAMP - 1; p >= 0; p = p - 1)
            if (p < pixels && token[`IN0_0_x + p * `IN0_STRIDE +: 16] < width && token[`IN0_0_y + p * `IN0_STRIDE +: 16] < height) begin
                any = 1'b1;
                x = token[`IN0_0_x + p * `IN0_STRIDE +: 16];
                y = token[`IN0_0_y + p * `IN0_STRIDE +: 16];
            end
    end
`endif
`ifdef IN0_packet_mask
    `define IN0_mask `IN0_packet_mask
    `define IN0_x `IN0_packet_x
    `define IN0_y `IN0_packet_y
`endif
`ifdef IN0_mask
    always @* begin
        any = 1'b0;
        pixels = 0;
        x = token[`IN0_x +: 16];
        y = token[`IN0_y +: 16];
        for (p = 0; p < 16; p = p + 1)
            if (token[`IN0_mask + p]) begin
                pixels = pixels + 16'd1;
                if (x + p < width && y < height) any = 1'b1;
            end
    end
`endif
endmodule
`default_nettype wire
