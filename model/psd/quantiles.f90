!> A cumulative distribution of sizes and its inverse.
module quantiles
  use kinds, only: wp
  implicit none
  private
  public :: quantiles_t

  !> Either single sizes with the share of each, or cells between edges, in each of which the density is linear.
  type :: quantiles_t
    logical :: discrete = .true.
    real(wp), allocatable :: edge(:)        !< (cells+1), rising; discrete: the sizes [m]
    real(wp), allocatable :: below(:)       !< share of all that is not larger than each edge [-]
    real(wp), allocatable :: density(:, :)  !< (2,cells) relative density at both ends of a cell
  contains
    procedure :: at                         !< the size below which a given share lies
    procedure :: share_below                !< the share below a given size
  end type quantiles_t

contains

  !> The size below which the share u lies [m].
  pure function at(self, u) result(d)
    class(quantiles_t), intent(in) :: self
    real(wp), intent(in) :: u  !< of [0,1]
    real(wp) :: d

    real(wp) :: part, place
    integer :: cell

    if (self%discrete) then
      d = self%edge(first_reaching(self%below, u))
      return
    end if
    cell = first_reaching(self%below(2:), u)
    place = 0.0_wp
    associate (f => self%density(:, cell), below => self%below(cell:cell + 1))
      if (below(2) > below(1) .and. u > below(1)) then
        place = min((u - below(1))/(below(2) - below(1)), 1.0_wp)
        part = place*(f(1) + f(2))
        if (part > 0.0_wp) place = part/(f(1) + sqrt(max(f(1)**2 + (f(2) - f(1))*part, 0.0_wp)))
      end if
    end associate
    d = self%edge(cell) + min(place, 1.0_wp)*(self%edge(cell + 1) - self%edge(cell))
  end function at

  !> The share of the sizes up to d [-].
  pure function share_below(self, d) result(share)
    class(quantiles_t), intent(in) :: self
    real(wp), intent(in) :: d  !< [m]
    real(wp) :: share

    real(wp) :: place
    integer :: cell

    share = 0.0_wp
    if (d < self%edge(1)) return
    if (self%discrete) then
      share = self%below(count(self%edge <= d))
      return
    end if
    cell = first_reaching(self%edge(2:), d)
    place = min((d - self%edge(cell))/(self%edge(cell + 1) - self%edge(cell)), 1.0_wp)
    associate (f => self%density(:, cell))
      if (f(1) + f(2) > 0.0_wp) place = place*(2.0_wp*f(1) + (f(2) - f(1))*place)/(f(1) + f(2))
    end associate
    share = self%below(cell) + place*(self%below(cell + 1) - self%below(cell))
  end function share_below

  !> The first place of a rising list with a value of at least x; the last where there is none.
  pure function first_reaching(list, x) result(place)
    real(wp), intent(in) :: list(:)
    real(wp), intent(in) :: x
    integer :: place

    integer :: low, middle

    low = 1
    place = size(list)
    do while (low < place)
      middle = (low + place)/2
      if (list(middle) >= x) then
        place = middle
      else
        low = middle + 1
      end if
    end do
  end function first_reaching

end module quantiles
