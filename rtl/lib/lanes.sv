// LANES inner products of one pseudo-normal N' with a row of reference normals, and the largest of them: of equals the lowest lane.
`default_nettype none
module lanes #(parameter LANES = 64, W = 16, I = $clog2(LANES)) (
    input  wire                   enable,
    input  wire [3*W-1:0]         normal,
    input  wire [LANES*3*W-1:0]   row,
    output reg  signed [2*W+1:0]  best,
    output reg  [I-1:0]           lane
);
    localparam P = 2 * W + 2;
    wire [LANES*P-1:0] products;
    genvar g;
    generate
        for (g = 0; g < LANES; g = g + 1) begin : search
            inner_product #(.W(W)) dot (.enable, .a(normal), .b(row[g*3*W +: 3*W]), .product(products[g*P +: P]));
        end
    endgenerate
    integer i;
    always @* begin
        best = products[0 +: P];
        lane = 0;
        if (enable)
            for (i = 1; i < LANES; i = i + 1)
                if ($signed(products[i*P +: P]) > best) begin
                    best = products[i*P +: P];
                    lane = i;
                end
    end
endmodule
`default_nettype wire
