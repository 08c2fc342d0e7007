// Graphics processor (104), Figure 1: texture times brightness, for bump targets from (106) on input 0 and plain polygons on input 1.
//
// Input 0 carries all control and defines the order. A plain polygon, and the token that ends it, have duplicates on input 1; the
// processor merges both. Timing twin for streamed drawing: the blend is in floating point, so the bench passes the pixels in (`pass0`).
`default_nettype none
module graphics #(parameter LATENCY = 1, AFTER = 1, PACE = 1) (
    input  wire               clk, rst,
    input  wire               in0_valid, in1_valid,
    input  wire [`IN0_W-1:0]  in0,
    input  wire [`IN1_W-1:0]  in1,
    output wire               in0_pop, in1_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    input  wire [`OUT0_W-1:0] pass0,
    input  wire               mem0_ready,
    input  wire [31:0]        answered,
    output wire               start
);
    localparam POLYGON = 2;
    localparam CONTROL = 0, FRAGMENTS = 1, DUPLICATE = 2;
    wire free;
    reg [1:0] phase;
    reg from, pending, textured;
    wire item = from ? in1[`IN1_item] : in0[`IN0_item];
    wire [2:0] kind = from ? in1[`IN1_kind +: 3] : in0[`IN0_kind +: 3];
    wire bump = from ? in1[`IN1_bump] : in0[`IN0_bump];
    wire is_plain = kind == POLYGON && !bump;
    wire [15:0] pixels = from ? in1[`IN1_count +: `IN1_count_N] : in0[`IN0_count +: `IN0_count_N];
    // A control token takes effect at once, or with its duplicate.
    wire waits = !item && !pending && (from || is_plain);
    assign start = free && (from ? in1_valid : in0_valid) && out0_room && mem0_ready;
    assign in0_pop = start && !from;
    assign in1_pop = start && from;
    assign out0_reserve = start && !waits;
    always @(posedge clk)
        if (rst) begin
            phase <= CONTROL;
            from <= 1'b0;
            pending <= 1'b0;
            textured <= 1'b0;
        end else if (start && !item) begin
            pending <= waits;
            if (waits) begin
                phase <= DUPLICATE;
                from <= !from;
            end else begin
                phase <= kind == POLYGON ? FRAGMENTS : CONTROL;
                from <= is_plain;
                if (kind == POLYGON) textured <= from ? in1[`IN1_textured] : in0[`IN0_textured];
            end
        end
    reg [`OUT0_W-1:0] control;
    always @* begin
        control = 0;
        control[`OUT0_kind +: 3] = kind;
        control[`OUT0_number +: 29] = from ? in1[`IN1_number +: 29] : in0[`IN0_number +: 29];
        control[`OUT0_width +: 57] = from ? in1[`IN1_width +: 57] : in0[`IN0_width +: 57];
    end
    occupancy busy (.clk, .rst, .start, .cycles(item ? pixels * PACE : 16'd1), .free);
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(out0_reserve), .data(item ? pass0 : control),
        .latency(item ? LATENCY + (pixels - 16'd1) * PACE : LATENCY), .counts(start && item && textured), .after(AFTER), .answered,
        .asked(), .push(out0_push), .out(out0));
endmodule
`default_nettype wire
