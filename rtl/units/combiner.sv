// Combiner (350) of the texel value generator, Figure 3: texture value times illuminance, for all pixels of a packet, one per cycle.
//
// Mode `replace`: the product replaces the old pixel, which is not read. Values saturate, and halves round up.
`default_nettype none
module combiner #(parameter INTERVAL = 1, LATENCY = 3) (
    input  wire               clk, rst,
    input  wire               in0_valid, in1_valid,
    input  wire [`IN0_W-1:0]  in0,
    input  wire [`IN1_W-1:0]  in1,
    output wire               in0_pop, in1_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    output wire               start
);
    wire free, item = in0[`IN0_item];
    wire [15:0] mask = in0[`IN0_packet_mask +: 16];
    assign start = free && in0_valid && in1_valid && out0_room;
    assign in0_pop = start;
    assign in1_pop = start;
    assign out0_reserve = start && !(item && mask == 0);
    reg [15:0] pixels;
    wire [3*16*8-1:0] values;
    genvar g;
    generate
        for (g = 0; g < 48; g = g + 1) begin : component
            modulate product (.texture(in0[`IN0_0_red + (g / 3) * 64 + (g % 3) * 16 +: 16]),
                .illuminance(in1[`IN1_0_red + (g / 3) * 64 + (g % 3) * 16 +: 16]), .value(values[8*g +: 8]));
        end
    endgenerate
    reg [`OUT0_W-1:0] result;
    integer p;
    always @* begin
        pixels = 0;
        result = 0;
        if (item) begin
            result[`OUT0_item] = 1'b1;
            result[`OUT0_x +: 48] = in0[`IN0_packet_x +: 48];
            for (p = 0; p < 16; p = p + 1) begin
                pixels = pixels + mask[p];
                if (mask[p]) result[`OUT0_0_rgb + p * 24 +: 24] = values[24*p +: 24];
            end
        end else result[`OUT0_kind +: 89] = in0[`IN0_kind +: 89];
    end
    wire [15:0] last = item && pixels != 0 ? (pixels - 16'd1) * INTERVAL : 16'd0;
    occupancy busy (.clk, .rst, .start, .cycles(item ? pixels * INTERVAL : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(LATENCY + 20)) deliver (.clk, .rst, .put(out0_reserve), .data(result), .latency(LATENCY + last),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
