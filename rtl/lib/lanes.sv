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
    // A tree of comparisons: in each round, half of the remaining lanes take over the larger value of a pair.
    reg signed [P-1:0] value [0:LANES-1];
    reg [I-1:0] place [0:LANES-1];
    integer i, stride;
    always @* begin
        for (i = 0; i < LANES; i = i + 1) begin
            value[i] = products[i*P +: P];
            place[i] = i;
        end
        if (enable)
            for (stride = 1; stride < LANES; stride = stride * 2)
                for (i = 0; i + stride < LANES; i = i + 2 * stride)
                    if (value[i+stride] > value[i]) begin
                        value[i] = value[i+stride];
                        place[i] = place[i+stride];
                    end
        best = value[0];
        lane = place[0];
    end
endmodule
`default_nettype wire
