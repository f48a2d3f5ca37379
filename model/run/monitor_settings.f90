!> A &monitor record: a named place and the quantity recorded there.
module monitor_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use monitor_quantities, only: quantities, monitor_kinds, find_quantity, fits_kind
  use text, only: word_length, shown
  implicit none
  private
  public :: monitor_settings_t, declare_monitor

  type :: monitor_settings_t
    character(len=word_length) :: id = ''
    character(len=word_length) :: kind = ''       !< 'point' | 'line' | 'plane' | 'box'
    real(wp) :: lower(3) = unset                  !< lowest corner; the place itself of a point [m]
    real(wp) :: upper(3) = unset                  !< highest corner; as lower for a point [m]
    character(len=word_length) :: quantity = ''   !< a name of monitor_quantities
    real(wp) :: interval = unset                  !< [s]; unset: monitor_interval of &output
  end type monitor_settings_t

contains

  !> The keys of the open record.
  subroutine declare_monitor(settings, keys)
    type(monitor_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    character(len=len(quantities%name)), parameter :: names(size(quantities)) = quantities%name

    call keys%get_id(settings%id, 'name of the monitor')
    call keys%get('kind', settings%kind, 'what the region is', choices(monitor_kinds), required=.true., when='always')
    call keys%get('lower', settings%lower, 'the point, or the lowest corner of the region [m]', required=.true., when='always')
    settings%upper = settings%lower
    call keys%get('upper', settings%upper, 'highest corner; as lower for a point [m]', &
                  required=settings%kind /= 'point', when='but for a point')
    call keys%get('quantity', settings%quantity, 'what is measured', choices(names), required=.true., when='always')
    call keys%get('interval', settings%interval, 'between values; that of &output if not given [s]', '(0, inf)')
    call check_monitor(settings, keys)
  end subroutine declare_monitor

  !> A line has an extent in one direction, a plane in two, a box in three.
  subroutine check_monitor(settings, keys)
    type(monitor_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    integer :: place, extents, k

    place = find_quantity(settings%quantity)
    if (place > 0 .and. len_trim(settings%kind) > 0) then
      call keys%require(fits_kind(place, settings%kind), 'quantity', 'is not measured in a '//trim(settings%kind))
      if (quantities(place)%of_gas) then
        call keys%require(keys%has_group('gas'), 'quantity', 'there is no &gas')
      else
        call keys%require(keys%has_group('parcels'), 'quantity', 'there are no &parcels')
      end if
    end if
    if (.not. all(is_set([settings%lower, settings%upper]))) return
    call keys%require(all(settings%upper >= settings%lower), 'upper', 'must not be below lower')
    extents = count(settings%upper > settings%lower)
    do k = 1, size(monitor_kinds)
      if (monitor_kinds(k) /= settings%kind) cycle
      call keys%require(extents == k - 1, 'upper', 'must differ from lower in '//shown(k - 1)//' directions for a ' &
                        //trim(settings%kind))
    end do
  end subroutine check_monitor

  !> 'a | b | c'
  pure function choices(names) result(text)
    character(len=*), intent(in) :: names(:)
    character(len=:), allocatable :: text

    integer :: i

    text = trim(names(1))
    do i = 2, size(names)
      text = text//' | '//trim(names(i))
    end do
  end function choices

end module monitor_settings
