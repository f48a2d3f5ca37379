!> How an inflow changes: by factors at times, linear between, constant before and after.
module inflow_ramp
  use kinds, only: wp
  implicit none
  private
  public :: inflow_ramp_t

  type :: inflow_ramp_t
    real(wp), allocatable :: times(:)    !< [s]
    real(wp), allocatable :: factors(:)
  contains
    procedure :: at
  end type inflow_ramp_t

contains

  !> Linear between the times; of times that are equal the last counts.
  pure function at(self, time) result(factor)
    class(inflow_ramp_t), intent(in) :: self
    real(wp), intent(in) :: time  !< [s]
    real(wp) :: factor

    integer :: below

    below = count(self%times <= time)
    if (below == 0) then
      factor = self%factors(1)
    else if (below == size(self%times)) then
      factor = self%factors(below)
    else
      associate (t => self%times(below:below + 1), f => self%factors(below:below + 1))
        factor = f(1) + (f(2) - f(1))*(time - t(1))/(t(2) - t(1))
      end associate
    end if
  end function at

end module inflow_ramp
