// Normal-vector mapping unit (108), Figure 1: pseudo-normals N' of each fragment, in two MIP levels, from the normal map in memory (116).
//
// Timing twin: the rotation is in floating point, so the bench passes the pseudo-normals in (`pass0`). The twin decides the pace of
// fragments, and waits for the texels of a polygon with a normal map.
`default_nettype none
module normal_mapping #(parameter LATENCY = 1, AFTER = 1, BARE = 1, parameter [9*16-1:0] PACE = 0) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire [`OUT0_W-1:0] pass0,
    input  wire               mem0_ready,
    input  wire [31:0]        answered,
    output wire               start
);
    localparam POLYGON = 2;
    wire free, item = in0[`IN0_item];
    reg mapped;
    wire [15:0] pixels = {{(16-`IN0_count_N){1'b0}}, in0[`IN0_count +: `IN0_count_N]};
    wire [3:0] samples = {{(4-`OUT0_samples_N){1'b0}}, pass0[`OUT0_samples +: `OUT0_samples_N]};
    wire [15:0] pace = mapped ? PACE[samples*16 +: 16] : BARE;
    wire [15:0] last = (pixels - 16'd1) * pace;
    assign start = free && in0_valid && out0_room && mem0_ready;
    assign in0_pop = start;
    assign out0_reserve = start;
    always @(posedge clk)
        if (rst) mapped <= 1'b0;
        else if (start && !item && in0[`IN0_kind +: 3] == POLYGON) mapped <= in0[`IN0_mapped];
    // Control has the same fields at both ends.
    reg [`OUT0_W-1:0] control;
    always @* begin
        control = 0;
        control[`OUT0_kind +: 3] = in0[`IN0_kind +: 3];
        control[`OUT0_number +: 29] = in0[`IN0_number +: 29];
        control[`OUT0_width +: 16] = in0[`IN0_width +: 16];
        control[`OUT0_height +: 16] = in0[`IN0_height +: 16];
        control[`OUT0_bump +: 25] = in0[`IN0_bump +: 25];
    end
    occupancy busy (.clk, .rst, .start, .cycles(item ? pixels * pace : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(start), .data(item ? pass0 : control),
        .latency(item ? LATENCY + last : LATENCY), .counts(start && item && mapped), .after(AFTER), .answered, .asked(),
        .push(out0_push), .out(out0));
endmodule
`default_nettype wire
