// Step calculator of the texel value generator (310), Figures 4A and 4B, with its storage element (claims 6 and 8): chooses the division
// points of a span by the accuracy criterion e.
//
// Timing twin for `texel.method` = adaptive. It decides in double precision whether a span is divided, and whether a step reaches its end.
// Quotient, root and coordinates pass through: the bench supplies the far end of each segment (`pass0`) and the points (`pass1`).
`default_nettype none
module step_calculator #(parameter LATENCY = 1, DECISION = 1, QUOTIENT = 16, ROOT = 16, FIRST = 1, NEXT = 1, MIN_SPAN = 4,
        parameter [63:0] CRITERION = 0) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room, out1_room,
    output wire               out0_reserve, out0_push, out1_reserve, out1_push,
    output wire [`OUT0_W-1:0] out0,
    output wire [`OUT1_W-1:0] out1,
    input  wire [`OUT0_W-1:0] pass0,
    input  wire [`OUT1_W-1:0] pass1,
    output wire               start
);
    localparam SELECTS = 5, SPAN = `IN0_weight_3 + `IN0_weight_3_N - `IN0_first_u;
    localparam [63:0] SIGN = 64'h8000000000000000;
    wire free;
    reg holds, divides;
    reg [SPAN-1:0] held;
    reg [15:0] from;
    // The storage element.
    reg [63:0] criterion;
    assign start = free && (holds || in0_valid) && out0_room && out1_room;
    assign in0_pop = start && !holds;
    wire item = holds || in0[`IN0_item], begins = in0_pop && in0[`IN0_item];
    wire [SPAN-1:0] span = holds ? held : in0[`IN0_first_u +: SPAN];
    wire [15:0] pixels = span[`IN0_pixels - `IN0_first_u +: 16], last = pixels - 16'd1, at = holds ? from : 16'd0;
    wire textured = span[`IN0_textured - `IN0_first_u];
    wire [63:0] left = span[`IN0_first_w - `IN0_first_u +: 64], right = span[`IN0_last_w - `IN0_first_u +: 64];
    wire [63:0] change = span[`IN0_step_w - `IN0_first_u +: 64], descent = change & ~SIGN;
    // Whether the bound holds to the end: t <= e, or W (t - e)^2 <= w (t + e)^2.
    wire [63:0] t, less, more, less_2, more_2, larger_side, smaller_side;
    float_round #(.E(11), .F(52), .W(55)) of_last (.sign(1'b0), .exponent(13'd1038), .magnitude({last, 39'd0}), .value(t));
    float_add #(.E(11), .F(52)) subtract (.a(t), .b(criterion ^ SIGN), .sum(less));
    float_add #(.E(11), .F(52)) sum_up (.a(t), .b(criterion), .sum(more));
    float_multiply #(.E(11), .F(52)) square_less (.a(less), .b(less), .product(less_2));
    float_multiply #(.E(11), .F(52)) square_more (.a(more), .b(more), .product(more_2));
    float_multiply #(.E(11), .F(52)) scale_large (.a(left < right ? right : left), .b(less_2), .product(larger_side));
    float_multiply #(.E(11), .F(52)) scale_small (.a(left < right ? left : right), .b(more_2), .product(smaller_side));
    wire keeps = less[63] || less == 0 || larger_side <= smaller_side;
    wire decides = textured && pixels > MIN_SPAN, is_divided = begins ? decides && !keeps : divides;
    // Whether the bound holds from this point on, however long the step: dw = 0, or dw < 0 and w <= e |dw|.
    wire [63:0] place, product, w, reach;
    float_round #(.E(11), .F(52), .W(55)) of_place (.sign(1'b0), .exponent(13'd1038), .magnitude({at, 39'd0}), .value(place));
    float_multiply #(.E(11), .F(52)) advance (.a(place), .b(change), .product);
    float_add #(.E(11), .F(52)) interpolate (.a(left), .b(product), .sum(w));
    float_multiply #(.E(11), .F(52)) of_reach (.a(criterion), .b(descent), .product(reach));
    wire is_free = descent == 0 || (change[63] && (at >= last && at != 0 ? right : w) <= reach);
    wire [15:0] beginning = begins && decides ? DECISION - 1 + (keeps ? 0 : QUOTIENT) : 16'd0;
    wire [15:0] turn = is_divided ? (at == 0 ? FIRST : NEXT) + (is_free ? 0 : ROOT) : 16'd1;
    wire [15:0] cycles = item ? beginning + turn : 16'd1, to = pass0[`OUT0_to +: 16];
    wire ends = to == last;
    reg [`OUT0_W-1:0] segment;
    reg [`OUT1_W-1:0] points;
    always @* begin
        segment = 0;
        points = pass1;
        if (item) begin
            segment[`OUT0_item] = 1'b1;
            segment[`OUT0_span_first_u +: SPAN] = span;
            segment[`OUT0_from +: 16] = at;
            segment[`OUT0_to +: 16] = to;
            segment[`OUT0_walk +: 16] = to - at + {15'd0, ends};
            segment[`OUT0_fresh] = at == 0;
        end else begin
            segment[`OUT0_criterion + `OUT0_criterion_N - 1:0] = in0[`IN0_criterion + `IN0_criterion_N - 1:0];
            points = 0;
            points[`OUT1_criterion + `OUT1_criterion_N - 1:0] = in0[`IN0_criterion + `IN0_criterion_N - 1:0];
        end
    end
    assign out0_reserve = start, out1_reserve = start;
    occupancy busy (.clk, .rst, .start, .cycles, .free);
    wire [15:0] latency = LATENCY + cycles - 16'd1;
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) segments (.clk, .rst, .put(start), .data(segment), .latency, .counts(1'b0), .after(16'd0),
        .answered(32'd0), .asked(), .push(out0_push), .out(out0));
    delivery #(.W(`OUT1_W), .DEPTH(`OUT1_DEPTH)) of_points (.clk, .rst, .put(start), .data(points), .latency, .counts(1'b0), .after(16'd0),
        .answered(32'd0), .asked(), .push(out1_push), .out(out1));
    always @(posedge clk)
        if (rst) begin
            holds <= 1'b0;
            divides <= 1'b0;
            criterion <= CRITERION;
        end else if (start) begin
            holds <= item && !ends;
            divides <= is_divided;
            from <= to;
            held <= span;
            if (!item && in0[`IN0_kind +: 3] == SELECTS) criterion <= in0[`IN0_criterion +: 64];
        end
endmodule
`default_nettype wire
