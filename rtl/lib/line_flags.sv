// Flags of the memory lines of a picture that nothing is drawn into. Lines beyond the flags are written at the beginning of the frame.
//
// FLAGS bounds the pictures that the twin can draw without lines beyond the flags. `examine` finds the next clear line from the last one on,
// PER_CYCLE flags in a cycle.
`default_nettype none
module line_flags #(parameter FLAGS = 512, LIMIT = 131072, PER_CYCLE = 64) (
    input  wire        clk, rst,
    input  wire        set,
    input  wire [31:0] lines,
    input  wire [31:0] line,
    input  wire        draw, examine, write_unflagged,
    output wire        is_clear, has_unflagged, is_found,
    output wire [31:0] unflagged, found, set_cycles, examine_cycles
);
    localparam F = $clog2(FLAGS);
    reg [FLAGS-1:0] clear;
    reg [31:0] next, flagged, beyond, count;
    wire [31:0] new_flags = lines < LIMIT ? lines : LIMIT;
    reg any;
    reg [31:0] first;
    integer i;
    always @* begin
        any = 1'b0;
        first = flagged == 0 ? 0 : flagged - 1;
        if (examine) for (i = FLAGS - 1; i >= 0; i = i - 1)
            if (i >= next && i < flagged && clear[i]) begin
                any = 1'b1;
                first = i;
            end
    end
    assign is_clear = line < flagged && clear[line[F-1:0]];
    assign has_unflagged = beyond < count;
    assign unflagged = beyond;
    assign is_found = any;
    assign found = first;
    assign set_cycles = (new_flags + PER_CYCLE - 1) / PER_CYCLE;
    assign examine_cycles = first / PER_CYCLE > next / PER_CYCLE ? first / PER_CYCLE - next / PER_CYCLE : 32'd1;
    always @(posedge clk)
        if (rst) begin
            next <= 0;
            flagged <= 0;
            beyond <= 0;
            count <= 0;
        end else begin
            if (set) begin
                clear <= {FLAGS{1'b1}};
                next <= 0;
                flagged <= new_flags;
                beyond <= new_flags;
                count <= lines;
            end else if (draw && line < flagged) clear[line[F-1:0]] <= 1'b0;
            if (examine) begin
                if (any) clear[first[F-1:0]] <= 1'b0;
                next <= any ? first + 1 : flagged;
            end
            if (write_unflagged) beyond <= beyond + 1;
        end
endmodule
`default_nettype wire
