// Geometry processor (102), Figure 1: transforms, clips, culls and projects triangles, and gives out their polygons.
//
// Timing twin: geometry is in floating point, and recorded commands carry no vertices. The bench passes the polygons in (`pass0`). With
// each command it passes the recorded occupancy, and whether a polygon follows. The twin decides starts, latency, and the number of the
// object. Its latency includes lighting at vertices, as in the machine `bump`.
`default_nettype none
module geometry #(parameter MULTIPLY = 1, ADD = 1, DIVIDE = 1, ROOT = 1, POWER = 1) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire [`OUT0_W-1:0] pass0,
    output wire               start
);
    localparam FRAME = 0, OBJECT = 1, TRIANGLE = 2;
    // Position, projection, area and LOD of a polygon, in parallel with transforming and lighting a normal.
    localparam OUTLINE = (1 + 2 + 1) * MULTIPLY + (3 + 1 + 2 + 1) * ADD + (1 + 1) * DIVIDE;
    localparam NORMAL = (3 + 3) * MULTIPLY + (4 + 4) * ADD + DIVIDE + ROOT + POWER;
    localparam [15:0] LATENCY = OUTLINE > NORMAL ? OUTLINE : NORMAL;
    wire free;
    wire [2:0] kind = in0[`IN0_kind +: 3];
    wire triangle = kind == TRIANGLE;
    wire [15:0] cycles = triangle || kind == OBJECT ? in0[`IN0_cycles +: 16] : 16'd1;
    // A dropped triangle waits for room as well, but takes none.
    assign start = free && in0_valid && out0_room;
    assign in0_pop = start;
    assign out0_reserve = start && (!triangle || in0[`IN0_drawn]);
    reg [`IN0_number_N-1:0] object;
    always @(posedge clk)
        if (start && kind == OBJECT) object <= in0[`IN0_number +: `IN0_number_N];
    reg [`OUT0_W-1:0] token;
    always @* begin
        token = triangle ? pass0 : 0;
        token[`OUT0_kind +: 3] = kind;
        token[`OUT0_number +: `OUT0_number_N] = triangle ? object : in0[`IN0_number +: `IN0_number_N];
        if (kind == FRAME) begin
            token[`OUT0_width +: 16] = pass0[`OUT0_width +: 16];
            token[`OUT0_height +: 16] = pass0[`OUT0_height +: 16];
        end
    end
    occupancy busy (.clk, .rst, .start, .cycles, .free);
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(out0_reserve), .data(token),
        .latency(LATENCY + cycles - 16'd1), .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
