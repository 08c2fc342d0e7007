// LANES inner products of one pseudo-normal N' with a row of reference normals, and the largest of them: of equals the lowest lane.
`default_nettype none
module lanes #(parameter LANES = 64, I = $clog2(LANES)) (
    input  wire                enable,
    input  wire [47:0]         normal,
    input  wire [LANES*48-1:0] row,
    output reg signed [33:0]   best,
    output reg  [I-1:0]        lane
);
    reg signed [33:0] product;
    integer i;
    always @* begin
        best = 34'sh200000000;
        lane = 0;
        product = 0;
        if (enable) for (i = 0; i < LANES; i = i + 1) begin
            product = $signed(normal[15:0]) * $signed(row[i*48 +: 16]) + $signed(normal[31:16]) * $signed(row[i*48+16 +: 16])
                + $signed(normal[47:32]) * $signed(row[i*48+32 +: 16]);
            if (product > best) begin
                best = product;
                lane = i[I-1:0];
            end
        end
    end
endmodule
`default_nettype wire
