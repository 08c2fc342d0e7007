// Memory lines that gather writes, in order of their last write. A touch of another line than these evicts the oldest one if there is no room.
`default_nettype none
module gathered_lines #(parameter LINES = 8) (
    input  wire        clk, clear,
    input  wire [31:0] line,
    input  wire        touch, take,
    output wire        is_newest, contains, evicts,
    output wire [31:0] oldest,
    output wire [7:0]  count
);
    reg [31:0] lines [0:LINES-1];
    reg [7:0] gathered;
    reg found;
    reg [7:0] place;
    integer i;
    always @* begin
        found = 1'b0;
        place = 0;
        for (i = 0; i < LINES; i = i + 1)
            if (i < gathered && lines[i] == line) begin
                found = 1'b1;
                place = i;
            end
    end
    assign contains = found;
    assign is_newest = found && place + 8'd1 == gathered;
    assign evicts = touch && !found && gathered == LINES;
    assign oldest = lines[0];
    assign count = gathered;
    wire [7:0] last = found || evicts ? gathered - 8'd1 : gathered;
    always @(posedge clk)
        if (clear) gathered <= 0;
        else if (touch && !is_newest) begin
            for (i = 0; i < LINES; i = i + 1)
                if (i == last) lines[i] <= line;
                else if (i + 1 < LINES && (found ? i >= place : evicts)) lines[i] <= lines[(i + 1) % LINES];
            if (!found && !evicts) gathered <= gathered + 8'd1;
        end else if (take && gathered != 0) begin
            gathered <= gathered - 8'd1;
            for (i = 0; i + 1 < LINES; i = i + 1) lines[i] <= lines[i+1];
        end
endmodule
`default_nettype wire
