!> A line of the description of a case.
module described_line
  implicit none
  private
  public :: line

contains

  subroutine line(unit, head, words)
    integer, intent(in) :: unit
    character(len=*), intent(in) :: head, words

    write (unit, '(a,t15,a)') head, words
  end subroutine line

end module described_line
