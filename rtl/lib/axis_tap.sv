// The two texels of a sample along one axis of a layer: S_i, and its neighbour if S_f is above 0 (Figure 5B, corrected). Combinational.
//
// `place` is in texels of the finest layer, `scaled_down` the number of halvings SF. With HALF, texel centres lie at halves.
`default_nettype none
module axis_tap #(parameter HALF = 1) (
    input  wire [31:0] place,
    input  wire [7:0]  scaled_down,
    input  wire [15:0] size,
    input  wire        repeats,
    output reg  [15:0] first, second
);
    wire [31:0] scaled = place[30:23] > scaled_down ? place - {1'b0, scaled_down, 23'd0} : 32'd0, shifted;
    float_add shift (.a(scaled), .b(32'hbf000000), .sum(shifted));
    wire signed [31:0] number;
    wire has_fraction;
    float_floor of_place (.x(HALF ? shifted : scaled), .whole(), .number, .has_fraction);
    wire signed [31:0] last = {16'd0, size} - 32'd1;
    always @* begin
        if (repeats) begin
            first = number < 0 || number > last ? last[15:0] : number[15:0];
            second = !has_fraction ? first : first == last[15:0] ? 16'd0 : first + 16'd1;
        end else begin
            // Beyond the edge the edge texel extends, without a neighbour.
            first = number < 0 ? 16'd0 : number >= last ? last[15:0] : number[15:0];
            second = number < 0 || number >= last ? first : first + {15'd0, has_fraction};
        end
    end
endmodule
`default_nettype wire
