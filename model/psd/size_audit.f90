!> The powder asked for beside the powder the parcels carry, each parcel counted W times.
module size_audit
  use constants, only: unset, is_set
  use kinds, only: wp
  use quantiles, only: quantiles_t
  use size_distribution, only: size_distribution_t
  use text, only: word_length
  use weighting, only: sphere_volume
  implicit none
  private
  public :: size_audit_t, size_summary_t, summary_asked, summary_made, write_audit, quantity_names, quantity_units

  !> What a sample of real particles amounts to, in the order of quantity_names.
  type :: size_summary_t
    real(wp) :: values(11) = unset  !< in SI units; unset: nobody asked
  end type size_summary_t

  !> One powder.
  type :: size_audit_t
    character(len=word_length) :: powder = ''  !< its id
    integer :: parcels = 0                     !< made of it
    type(size_summary_t) :: asked              !< by the case
    type(size_summary_t) :: made               !< carried by the parcels
  end type size_audit_t

  integer, parameter :: name_length = 26
  character(len=*), parameter :: quantity_names(11) = [character(len=name_length) :: 'real particles', 'mass', &
    'number-mean diameter', 'mass-mean diameter', 'Sauter-mean diameter', 'd10 by mass', 'd50 by mass', 'd90 by mass', &
    'd50 by number', 'smallest diameter', 'largest diameter']
  character(len=*), parameter :: quantity_units(11) = [character(len=2) :: '-', 'kg', spread('m', 1, 9)]

contains

  !> Of a distribution and, where it is known, its mass.
  pure function summary_asked(distribution, density, mass) result(summary)
    type(size_distribution_t), intent(in) :: distribution
    real(wp), intent(in) :: density  !< of a particle [kg/m3]
    real(wp), intent(in) :: mass     !< [kg] or unset
    type(size_summary_t) :: summary

    type(quantiles_t) :: by_number, by_mass

    by_number = distribution%weighted_by(0.0_wp)
    by_mass = distribution%weighted_by(3.0_wp)
    if (is_set(mass)) then
      summary%values(1) = mass/(density*sphere_volume(1.0_wp)*distribution%moment(3.0_wp))
      summary%values(2) = mass
    end if
    summary%values(3:) = [distribution%number_mean(), distribution%mass_mean(), distribution%sauter_mean(), &
      by_mass%at(0.1_wp), by_mass%at(0.5_wp), by_mass%at(0.9_wp), by_number%at(0.5_wp), distribution%limits]
  end function summary_asked

  !> Of parcels.
  pure function summary_made(diameter, weight, density) result(summary)
    real(wp), intent(in) :: diameter(:)  !< of the real particles [m]
    real(wp), intent(in) :: weight(:)    !< real particles per parcel [-]
    real(wp), intent(in) :: density      !< of a particle [kg/m3]
    type(size_summary_t) :: summary

    integer, allocatable :: order(:)
    real(wp), allocatable :: mass(:)
    real(wp) :: moment(0:4)
    integer :: q

    if (size(diameter) == 0) return
    do q = 0, 4
      moment(q) = sum(weight*diameter**q)
    end do
    call sort_by(diameter, order)
    allocate (mass, source=weight*density*sphere_volume(diameter))
    summary%values = [moment(0), sum(mass), moment(1)/moment(0), moment(4)/moment(3), moment(3)/moment(2), &
      quantile(diameter, mass, order, 0.1_wp), quantile(diameter, mass, order, 0.5_wp), &
      quantile(diameter, mass, order, 0.9_wp), quantile(diameter, weight, order, 0.5_wp), &
      minval(diameter), maxval(diameter)]
  end function summary_made

  !> The first size at which the parcels up to it hold the share u of all.
  pure function quantile(diameter, amount, order, u) result(d)
    real(wp), intent(in) :: diameter(:)  !< [m]
    real(wp), intent(in) :: amount(:)    !< held by each parcel
    integer, intent(in) :: order(:)      !< of rising diameter
    real(wp), intent(in) :: u
    real(wp) :: d

    real(wp) :: needed
    integer :: i

    needed = u*sum(amount)
    do i = 1, size(order) - 1
      needed = needed - amount(order(i))
      if (needed <= 0.0_wp) exit
    end do
    d = diameter(order(i))
  end function quantile

  !> The order in which a list rises; equal values keep theirs (merge sort from the bottom up).
  pure subroutine sort_by(list, order)
    real(wp), intent(in) :: list(:)
    integer, allocatable, intent(out) :: order(:)

    integer, allocatable :: merged(:)
    integer :: i, length, low, n

    n = size(list)
    allocate (order(n), merged(n))
    do i = 1, n
      order(i) = i
    end do
    length = 1
    do while (length < n)
      do low = 1, n, 2*length
        call merge_runs(list, order(low:min(low + 2*length - 1, n)), length, merged(low:min(low + 2*length - 1, n)))
      end do
      call move_alloc(merged, order)
      allocate (merged(n))
      length = 2*length
    end do
  end subroutine sort_by

  !> Two neighbouring runs of an order, the first of `length`, made one.
  pure subroutine merge_runs(list, runs, length, merged)
    real(wp), intent(in) :: list(:)
    integer, intent(in) :: runs(:)
    integer, intent(in) :: length
    integer, intent(out) :: merged(:)

    integer :: left, right, i
    logical :: take_left

    left = 1
    right = length + 1
    do i = 1, size(runs)
      take_left = left <= min(length, size(runs))
      if (take_left .and. right <= size(runs)) take_left = list(runs(left)) <= list(runs(right))
      if (take_left) then
        merged(i) = runs(left)
        left = left + 1
      else
        merged(i) = runs(right)
        right = right + 1
      end if
    end do
  end subroutine merge_runs

  !> A table of one powder: quantity, unit, asked, made, difference. Diameters are shown in micrometres.
  subroutine write_audit(unit, audit)
    integer, intent(in) :: unit  !< of an open text file
    type(size_audit_t), intent(in) :: audit

    character(len=13) :: asked, difference
    character(len=2) :: shown_unit
    real(wp) :: scale
    integer :: i

    write (unit, '(3a,i0,a)') "powder '", trim(audit%powder), "' in ", audit%parcels, ' parcels'
    write (unit, '(2x,a,t30,a,t33,3a14)') 'of the real particles', '', 'asked', 'made', 'difference'
    do i = 1, size(quantity_names)
      if (.not. is_set(audit%made%values(i))) cycle
      scale = merge(1.0e6_wp, 1.0_wp, quantity_units(i) == 'm')
      shown_unit = merge('um', quantity_units(i), quantity_units(i) == 'm')
      asked = '-'
      difference = '-'
      if (is_set(audit%asked%values(i))) then
        asked = figures(scale*audit%asked%values(i))
        write (difference, '(sp,f10.3,a)') 100.0_wp*(audit%made%values(i)/audit%asked%values(i) - 1.0_wp), ' %'
      end if
      write (unit, '(2x,a,t30,a,t33,3a14)') quantity_names(i), shown_unit, adjustr(asked), &
        adjustr(figures(scale*audit%made%values(i))), adjustr(difference)
    end do
  end subroutine write_audit

  !> Six figures.
  pure function figures(x) result(text)
    real(wp), intent(in) :: x
    character(len=13) :: text

    character(len=8) :: form

    form = '(es13.5)'
    if (abs(x) >= 1.0e-3_wp .and. abs(x) < 1.0e6_wp) write (form, '(a,i1,a)') '(f13.', 5 - floor(log10(abs(x))), ')'
    write (text, form) x
  end function figures

end module size_audit
