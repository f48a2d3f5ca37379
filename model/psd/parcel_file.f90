!> Parcels that start where a file says.
module parcel_file
  use cloud, only: cloud_t, new_cloud
  use kinds, only: wp
  use outcome, only: outcome_t, exit_input
  use parcel_table, only: parcel_table_t, read_parcel_table, column_names, place_of_row
  use parcels_settings, only: fill_settings_t
  use problems, only: problems_t
  use text, only: shown
  use vessel, only: vessel_t
  use weighting, only: weighting_t
  implicit none
  private
  public :: read_parcel_file

  integer, parameter :: told = 10  !< problems of one file that are written out

contains

  !> The parcels of a file, each with the weight the file gives or else that of its size.
  subroutine read_parcel_file(fill, weighting, vessel, parcels, outcome)
    type(fill_settings_t), intent(in) :: fill  !< whose velocity holds where the file has none
    type(weighting_t), intent(in) :: weighting
    type(vessel_t), intent(in) :: vessel
    type(cloud_t), intent(out) :: parcels
    type(outcome_t), intent(inout) :: outcome

    type(parcel_table_t) :: table
    type(problems_t) :: problems
    integer :: row

    call read_parcel_table(trim(fill%file), table, problems)
    if (problems%count() == 0) call check_rows(table, vessel, problems)
    if (problems%count() > 0) then
      call outcome%fail(exit_input, joined(problems))
      return
    end if
    parcels = new_cloud(size(table%line))
    parcels%position(:, :) = table%values(1:3, :)
    parcels%velocity(:, :) = table%values(7:9, :)
    if (.not. table%given(7)) parcels%velocity(:, :) = spread(fill%velocity, 2, parcels%n)
    do row = 1, parcels%n
      associate (d => table%values(4, row), weight => table%values(5, row), diameter => table%values(6, row))
        parcels%diameter(row) = d
        if (table%given(5)) then
          parcels%weight(row) = weight
          parcels%contact_diameter(row) = d*weight**(1.0_wp/3.0_wp)
        else if (table%given(6)) then
          parcels%weight(row) = (diameter/d)**3
          parcels%contact_diameter(row) = diameter
        else
          parcels%weight(row) = weighting%weight(d)
          parcels%contact_diameter(row) = weighting%collision_diameter(d)
        end if
      end associate
    end do
  end subroutine read_parcel_file

  !> Sizes are positive, centres inside.
  subroutine check_rows(table, vessel, problems)
    type(parcel_table_t), intent(in) :: table
    type(vessel_t), intent(in) :: vessel
    type(problems_t), intent(inout) :: problems

    integer :: row, i

    do row = 1, size(table%line)
      do i = 4, 6
        if (table%given(i) .and. table%values(i, row) <= 0.0_wp) call problems%add(place_of_row(table, row)// &
          ': '//trim(column_names(i))//' = '//shown(table%values(i, row))//' must be positive')
      end do
      do i = 1, 3
        if (table%values(i, row) < vessel%lower(i) .or. table%values(i, row) > vessel%upper(i)) then
          call problems%add(place_of_row(table, row)//': '//trim(column_names(i))//' = '// &
                            shown(table%values(i, row))//' m is outside the domain, '// &
                            shown(vessel%lower(i))//' to '//shown(vessel%upper(i)))
        end if
      end do
    end do
  end subroutine check_rows

  !> The first problems, one per line, and how many more there are.
  pure function joined(problems) result(message)
    type(problems_t), intent(in) :: problems
    character(len=:), allocatable :: message

    integer :: i

    message = problems%message(1)
    do i = 2, min(problems%count(), told)
      message = message//new_line('a')//problems%message(i)
    end do
    if (problems%count() > told) message = message//new_line('a')//'and '//shown(problems%count() - told)//' more'
  end function joined

end module parcel_file
