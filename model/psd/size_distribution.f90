!> The real particle size distribution of a powder: its moments, and its quantiles under any weighting.
!>
!> Every distribution is held as shares of the number of particles at a set of sizes: the sizes themselves
!> where there are only some (single, number_table), else the points of a Gauss-Legendre rule in narrow cells
!> between the smallest and the largest size (normal, log_normal, sieve_table). The number mean of d^q is then
!>
!>   <d^q> = sum_i share_i d_i^q
!>
!> A distribution by mass becomes one by number as p_N(d) ~ p_M(d)/d^3. Limits of the diameter truncate: what
!> lies outside is left out and the rest scaled up to 1, so no particles gather at a limit. Mean and standard
!> deviation are those of the distribution without limits.
module size_distribution
  use constants, only: unset, is_set
  use kinds, only: wp
  use outcome, only: outcome_t, exit_input
  use powder_settings, only: powder_settings_t
  use quantiles, only: quantiles_t
  implicit none
  private
  public :: size_distribution_t, new_size_distribution

  type :: size_distribution_t
    logical :: discrete = .true.           !< only the sizes of `diameter` occur
    real(wp) :: limits(2) = unset          !< smallest and largest particle; unset where there is no limit [m]
    real(wp), allocatable :: diameter(:)   !< sizes or quadrature points, rising [m]
    real(wp), allocatable :: share(:)      !< of the number of particles at each, together 1 [-]
    real(wp), allocatable :: edge(:)       !< (cells+1) edges of the cells, rising [m]; not if discrete
    real(wp), allocatable :: density(:, :)  !< (2,cells) relative number density at both ends of a cell
  contains
    procedure :: moment                    !< <d^q>
    procedure :: number_mean               !< <d>
    procedure :: mass_mean                 !< <d^4>/<d^3>
    procedure :: sauter_mean               !< <d^3>/<d^2>
    procedure :: weighted_by               !< of the distribution ~ d^q p_N(d)
  end type size_distribution_t

  integer, parameter :: cells_wanted = 2048
  real(wp), parameter :: deviations = 8.0_wp  !< a tail this far out holds 1e-15 of a normal distribution
  real(wp), parameter :: closure = 1.0e-3_wp  !< how far the sum of a table may be from 1

  ! Gauss-Legendre rule of four points on [0,1]; Abramowitz and Stegun, table 25.4
  real(wp), parameter :: point(4) = 0.5_wp + 0.5_wp*[-0.861136311594052575_wp, -0.339981043584856265_wp, &
    0.339981043584856265_wp, 0.861136311594052575_wp]
  real(wp), parameter :: point_weight(4) = 0.5_wp*[0.347854845137453857_wp, 0.652145154862546143_wp, &
    0.652145154862546143_wp, 0.347854845137453857_wp]

contains

  !> The distribution a powder asks for. Fails where it holds no particle or a key it needs is missing.
  subroutine new_size_distribution(powder, distribution, outcome)
    type(powder_settings_t), intent(in) :: powder
    type(size_distribution_t), intent(out) :: distribution
    type(outcome_t), intent(inout) :: outcome

    character(len=:), allocatable :: fault

    fault = fault_of(powder)
    if (len(fault) == 0) then
      select case (powder%distribution)
      case ('single')
        call fill_discrete(powder, [powder%mean_diameter], [1.0_wp], distribution)
      case ('number_table')
        call fill_discrete(powder, powder%sizes, powder%fractions, distribution)
      case default
        call fill_continuous(powder, distribution)
      end select
      distribution%limits = known_limits(powder, distribution)
      if (sum(distribution%share) > 0.0_wp) then
        distribution%share = distribution%share/sum(distribution%share)
      else
        fault = 'no particle lies between minimum_diameter and maximum_diameter'
      end if
    end if
    if (len(fault) > 0) call outcome%fail(exit_input, "&powder id = '"//trim(powder%id)//"': "//fault)
  end subroutine new_size_distribution

  !> The ends of a table and the user's limits, but not where a tail is merely cut off.
  pure function known_limits(powder, distribution) result(limits)
    type(powder_settings_t), intent(in) :: powder
    type(size_distribution_t), intent(in) :: distribution
    real(wp) :: limits(2)

    logical :: known(2)

    limits = unset
    if (size(distribution%diameter) == 0) return
    if (distribution%discrete) then
      limits = [distribution%diameter(1), distribution%diameter(size(distribution%diameter))]
    else
      limits = [distribution%edge(1), distribution%edge(size(distribution%edge))]
      known = limits - natural_limits(powder) > 0.0_wp .or. limits - natural_limits(powder) < 0.0_wp
      limits = merge(limits, unset, known .or. powder%distribution == 'sieve_table')
    end if
  end function known_limits

  !> What makes a powder unusable, or nothing.
  pure function fault_of(powder) result(fault)
    type(powder_settings_t), intent(in) :: powder
    character(len=:), allocatable :: fault

    fault = ''
    select case (powder%distribution)
    case ('single')
      if (powder%mean_diameter <= 0.0_wp) fault = 'mean_diameter is missing or not positive'
    case ('normal', 'log_normal')
      if (powder%mean_diameter <= 0.0_wp) fault = 'mean_diameter is missing or not positive'
      if (powder%standard_deviation <= 0.0_wp) fault = 'standard_deviation is missing or not positive'
      if (len(fault) == 0) then
        if (minval(natural_limits(powder)) <= 0.0_wp .and. powder%minimum_diameter <= 0.0_wp) then
          fault = 'a normal distribution this wide needs a positive minimum_diameter'
        end if
      end if
    case ('sieve_table', 'number_table')
      fault = fault_of_table(powder)
    case default
      fault = "distribution '"//trim(powder%distribution)//"' is not known"
    end select
  end function fault_of

  pure function fault_of_table(powder) result(fault)
    type(powder_settings_t), intent(in) :: powder
    character(len=:), allocatable :: fault

    integer :: n

    fault = 'its table has no sizes or not as many fractions'
    if (.not. (allocated(powder%sizes) .and. allocated(powder%fractions))) return
    n = size(powder%sizes)
    if (n < 1 .or. size(powder%fractions) /= n) return
    fault = 'the sizes of its table must be positive and rise'
    if (any(powder%sizes <= 0.0_wp) .or. any(powder%sizes(2:) <= powder%sizes(:n - 1))) return
    fault = ''
    if (powder%distribution == 'number_table') then
      if (any(powder%fractions < 0.0_wp) .or. abs(sum(powder%fractions) - 1.0_wp) > closure) then
        fault = 'the fractions of its table must not be negative and together be 1'
      end if
    else if (n < 2 .or. abs(powder%fractions(1)) > 0.0_wp .or. abs(powder%fractions(n) - 1.0_wp) > closure &
      .or. any(powder%fractions(2:) < powder%fractions(:n - 1))) then
      fault = 'the fractions of its table must rise from 0 at the first size to 1 at the last'
    end if
  end function fault_of_table

  !> The sizes of a table that lie within the limits.
  pure subroutine fill_discrete(powder, sizes, fractions, distribution)
    type(powder_settings_t), intent(in) :: powder
    real(wp), intent(in) :: sizes(:)      !< [m]
    real(wp), intent(in) :: fractions(:)  !< by number [-]
    type(size_distribution_t), intent(inout) :: distribution

    real(wp) :: limits(2)
    logical :: kept(size(sizes))

    limits = limits_of(powder, [sizes(1), sizes(size(sizes))])
    kept = sizes >= limits(1) .and. sizes <= limits(2)
    distribution%discrete = .true.
    distribution%diameter = pack(sizes, kept)
    distribution%share = pack(fractions, kept)
  end subroutine fill_discrete

  !> Cells between the limits, the density at their ends and the share at their quadrature points.
  subroutine fill_continuous(powder, distribution)
    type(powder_settings_t), intent(in) :: powder
    type(size_distribution_t), intent(inout) :: distribution

    real(wp) :: d(4)
    integer :: cell, cells

    distribution%discrete = .false.
    distribution%edge = edges_of(powder)
    cells = size(distribution%edge) - 1
    allocate (distribution%density(2, cells), distribution%diameter(4*cells), distribution%share(4*cells))
    do cell = 1, cells
      associate (ends => distribution%edge(cell:cell + 1))
        d = ends(1) + point*(ends(2) - ends(1))
        distribution%density(:, cell) = number_density(powder, ends, 0.5_wp*sum(ends))
        distribution%diameter(4*cell - 3:4*cell) = d
        distribution%share(4*cell - 3:4*cell) = &
          number_density(powder, d, 0.5_wp*sum(ends))*point_weight*(ends(2) - ends(1))
      end associate
    end do
  end subroutine fill_continuous

  !> Number density at the sizes d, up to a factor. A sieve table has steps: `inside` says on which side of one.
  pure function number_density(powder, d, inside) result(density)
    type(powder_settings_t), intent(in) :: powder
    real(wp), intent(in) :: d(:)    !< [m]
    real(wp), intent(in) :: inside  !< a size in the middle of the cell [m]
    real(wp) :: density(size(d))

    real(wp) :: spread
    integer :: i

    select case (powder%distribution)
    case ('normal')
      density = exp(-0.5_wp*((d - powder%mean_diameter)/powder%standard_deviation)**2)
    case ('log_normal')
      spread = log_spread(powder)
      density = exp(-0.5_wp*((log(d/powder%mean_diameter) + 0.5_wp*spread**2)/spread)**2)*powder%mean_diameter/d
    case default
      i = max(count(powder%sizes <= inside), 1)
      density = (powder%fractions(i + 1) - powder%fractions(i))/(powder%sizes(i + 1) - powder%sizes(i))
    end select
    if (by_mass(powder)) density = density*(reference_size(powder)/d)**3
  end function number_density

  !> A size that d^-3 is counted in, to keep the numbers near 1 [m].
  pure function reference_size(powder) result(scale)
    type(powder_settings_t), intent(in) :: powder
    real(wp) :: scale

    scale = powder%mean_diameter
    if (powder%distribution == 'sieve_table') scale = powder%sizes(1)
  end function reference_size

  pure function by_mass(powder)
    type(powder_settings_t), intent(in) :: powder
    logical :: by_mass

    by_mass = powder%basis == 'mass' .or. powder%distribution == 'sieve_table'
  end function by_mass

  !> Standard deviation of ln d: sqrt(ln(1 + (standard deviation/mean)^2)).
  pure function log_spread(powder) result(spread)
    type(powder_settings_t), intent(in) :: powder
    real(wp) :: spread

    spread = sqrt(log(1.0_wp + (powder%standard_deviation/powder%mean_diameter)**2))
  end function log_spread

  !> Cell edges in equal steps of ln d between the limits; a sieve table has cells of its own in each interval.
  pure function edges_of(powder) result(edge)
    type(powder_settings_t), intent(in) :: powder
    real(wp), allocatable :: edge(:)

    real(wp) :: limits(2)
    real(wp), allocatable :: corner(:)
    integer :: i, interval, cells

    limits = limits_of(powder, natural_limits(powder))
    limits(2) = max(limits(1), limits(2))
    if (powder%distribution == 'sieve_table') then
      allocate (corner, source=[limits(1), &
        pack(powder%sizes, powder%sizes > limits(1) .and. powder%sizes < limits(2)), limits(2)])
    else
      allocate (corner, source=limits)
    end if
    cells = max(cells_wanted/(size(corner) - 1), 64)
    allocate (edge(cells*(size(corner) - 1) + 1))
    do interval = 1, size(corner) - 1
      do i = 0, cells - 1
        edge(cells*(interval - 1) + i + 1) = corner(interval)*(corner(interval + 1)/corner(interval))**(real(i, wp)/cells)
      end do
    end do
    edge(size(edge)) = corner(size(corner))
  end function edges_of

  !> Where a distribution without limits ends for all purposes, by number and by mass [m].
  pure function natural_limits(powder) result(limits)
    type(powder_settings_t), intent(in) :: powder
    real(wp) :: limits(2)

    real(wp) :: spread, middle(2)

    select case (powder%distribution)
    case ('normal')
      limits = powder%mean_diameter + [-1.0_wp, 1.0_wp]*deviations*powder%standard_deviation
    case ('log_normal')
      spread = log_spread(powder)
      middle = log(powder%mean_diameter) - 0.5_wp*spread**2 + [0.0_wp, 3.0_wp]*spread**2
      if (by_mass(powder)) middle = middle - 3.0_wp*spread**2
      limits = exp(middle + [-1.0_wp, 1.0_wp]*deviations*spread)
    case default
      limits = [powder%sizes(1), powder%sizes(size(powder%sizes))]
    end select
  end function natural_limits

  !> The narrower of the user's limits and the natural ones; in falling order where nothing lies between [m].
  pure function limits_of(powder, natural) result(limits)
    type(powder_settings_t), intent(in) :: powder
    real(wp), intent(in) :: natural(2)  !< [m]
    real(wp) :: limits(2)

    limits = natural
    if (is_set(powder%minimum_diameter)) limits(1) = max(limits(1), powder%minimum_diameter)
    if (is_set(powder%maximum_diameter)) limits(2) = min(limits(2), powder%maximum_diameter)
  end function limits_of

  !> Number mean of d^q [m^q].
  pure function moment(self, q) result(mean)
    class(size_distribution_t), intent(in) :: self
    real(wp), intent(in) :: q
    real(wp) :: mean

    mean = sum(self%share*self%diameter**q)
  end function moment

  !> Mean diameter of the particles counted [m].
  pure function number_mean(self) result(d)
    class(size_distribution_t), intent(in) :: self
    real(wp) :: d

    d = self%moment(1.0_wp)
  end function number_mean

  !> Mean diameter of the particles weighed [m].
  pure function mass_mean(self) result(d)
    class(size_distribution_t), intent(in) :: self
    real(wp) :: d

    d = self%moment(4.0_wp)/self%moment(3.0_wp)
  end function mass_mean

  !> Diameter with the surface per volume of the powder [m].
  pure function sauter_mean(self) result(d)
    class(size_distribution_t), intent(in) :: self
    real(wp) :: d

    d = self%moment(3.0_wp)/self%moment(2.0_wp)
  end function sauter_mean

  !> The cumulative distribution of d^q p_N(d): q = 0 counts particles, q = 3 weighs them.
  pure function weighted_by(self, q) result(table)
    class(size_distribution_t), intent(in) :: self
    real(wp), intent(in) :: q
    type(quantiles_t) :: table

    real(wp) :: part(size(self%share)), largest
    integer :: i, cells

    largest = maxval(self%diameter)
    part = self%share*(self%diameter/largest)**q
    table%discrete = self%discrete
    if (self%discrete) then
      allocate (table%edge, source=self%diameter)
      allocate (table%below, source=part)
      do i = 2, size(part)
        table%below(i) = table%below(i - 1) + part(i)
      end do
    else
      cells = size(self%density, 2)
      allocate (table%edge, source=self%edge)
      allocate (table%density(2, cells), table%below(cells + 1))
      table%below(1) = 0.0_wp
      do i = 1, cells
        table%density(:, i) = self%density(:, i)*(self%edge(i:i + 1)/largest)**q
        table%below(i + 1) = table%below(i) + sum(part(4*i - 3:4*i))
      end do
    end if
    table%below = table%below/table%below(size(table%below))
  end function weighted_by

end module size_distribution
