// Brightness of one fragment: the sum of the entries of its MIP levels, each times its share. Combinational.
`default_nettype none
module blend #(parameter BITS = 8, SAMPLES = 2, SHARE = 8) (
    input  wire [SAMPLES*SHARE-1:0]  shares,
    input  wire [SAMPLES*BITS-1:0]   entries,
    output reg  [BITS+SHARE:0]       sum
);
    reg [BITS+SHARE-1:0] product;
    integer j;
    always @* begin
        sum = 0;
        product = 0;
        for (j = 0; j < SAMPLES; j = j + 1) begin
            product = shares[j*SHARE +: SHARE] * entries[j*BITS +: BITS];
            sum = sum + product;
        end
    end
endmodule
`default_nettype wire
